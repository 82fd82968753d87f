//! How the extension module is linked.

use std::env::var;

fn main() {
    // On macOS the symbols of Python are looked up when the module is loaded.
    pyo3_build_config::add_extension_module_link_args();
    // Wheels are without debug information. A setting of the profile would compile every crate
    // anew.
    let (system, profile) = (var("CARGO_CFG_TARGET_OS"), var("PROFILE"));
    if system.as_deref() == Ok("linux") && profile.as_deref() == Ok("release") {
        println!("cargo::rustc-cdylib-link-arg=-Wl,--strip-all");
    }
}
