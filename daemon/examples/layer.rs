//! A layer process without a program of its own: the manifest in the file that `LAYER_MANIFEST` names, made of the
//! kinds that the daemon was built with. Tests of the daemon start it; so may who only needs stock modules.

fn main() -> std::process::ExitCode {
    let Some(path) = std::env::var_os("LAYER_MANIFEST") else {
        eprintln!("LAYER_MANIFEST is not set; expected the path of a layer's manifest (TOML)");
        return std::process::ExitCode::from(2);
    };
    let path = std::path::PathBuf::from(path);
    match std::fs::read_to_string(&path) {
        Ok(text) => {
            let manifest = ipc::wiring::Source::of_file(&path, text);
            afsm::process::run(manifest, daemon::machine::kinds())
        }
        Err(e) => {
            eprintln!("{}: cannot be read: {e}", path.display());
            std::process::ExitCode::from(2)
        }
    }
}
