#!/bin/sh
# Makes ten bundles for checking other tracers, each in a folder of its own:
#
#     examples/bundles.sh bundles             # all ten
#     examples/bundles.sh bundles corridor    # some of them
#
# FREDHOLM names the program (default: fredholm). Faces are traced to a standard error of TO
# (default 0.1%), or for LIMIT seconds (default 600) where that comes first; every pixel gets SPP samples
# (default 16384). docs/bundles.md says what each scene catches.
set -eu
program=${FREDHOLM:-fredholm}
scenes=$(dirname "$0")/../scenes
folder=${1:?give the folder for the bundles}
shift
all="furnace cornell occluder two_rooms white_room sphere studio corridor courtyard fifty_boxes"

# Scene, size of the picture and error of a row of form factors of a bundle.
of() {
    case $1 in
        furnace) echo "furnace_colours 32x32 1e-7" ;;
        cornell) echo "cornell_planar 48x48 1e-6" ;;
        occluder) echo "occluder 48x48 1e-6" ;;
        two_rooms) echo "two_rooms 64x48 1e-6" ;;
        white_room) echo "white_room 48x36 1e-7" ;;
        sphere) echo "sphere 48x48 1e-6" ;;
        studio) echo "studio 48x32 1e-3" ;;
        corridor) echo "corridor 48x64 1e-6" ;;
        courtyard) echo "courtyard 64x48 1e-6" ;;
        fifty_boxes) echo "fifty_boxes 64x48 1e-5" ;;
        *) echo "there is no bundle $1; there are: $all" >&2; exit 2 ;;
    esac
}

for name in ${*:-$all}; do
    settings=$(of "$name")
    # shellcheck disable=SC2086 # the three words are three arguments
    set -- $settings
    "$program" reference "$scenes/$1.toml" --output "$folder/$name" --size "$2" \
        --form-factor-tolerance "$3" --spp "${SPP:-16384}" --to "${TO:-0.1%}" --seconds "${LIMIT:-600}"
done
