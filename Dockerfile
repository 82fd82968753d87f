# Fredholm in a container:
#
#     docker build -t fredholm .
#     docker run --rm -v "$PWD":/work fredholm solve scene.toml -o out
#
# Results belong to root unless --user "$(id -u):$(id -g)" is given. The memory that the program may
# take follows --memory of the container (control groups, docs/memory.md).
#
# Not tried: this file was written where no container could be built. Its steps were taken from what
# is known to work without one: the build asks for the Rust toolchain and a C compiler alone, and
# packaging/notices.py for Python. Platforms other than x86-64 are not tried either.

FROM rust:1.95-slim-bookworm AS build
RUN apt-get update \
    && apt-get install -y --no-install-recommends gcc libc6-dev python3 \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /src
COPY . .
RUN cargo build --release --locked --bin fredholm \
    && python3 packaging/notices.py -o /THIRD-PARTY-LICENSES.txt

FROM debian:bookworm-slim
COPY --from=build /src/target/release/fredholm /usr/local/bin/fredholm
COPY --from=build /src/LICENSE-APACHE /src/LICENSE-MIT /THIRD-PARTY-LICENSES.txt \
    /usr/share/doc/fredholm/
COPY --from=build /src/scenes /usr/share/fredholm/scenes
WORKDIR /work
ENTRYPOINT ["fredholm"]
CMD ["--help"]
