//! Random valid scenes through all commands, each in a process of its own with limits.

use std::fs::{self, File};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use fredholm_generate::Case;

use crate::settings::{first, keep, number};

/// CPU time of a run, s, and the time that it is given: bright rooms may take longer, and then it
/// has to end by itself.
const SECONDS: u64 = 60;
const TIME_LIMIT: &str = "25s";
/// Elapsed time of a run: a run that only waits ends too.
const MOST_ELAPSED: Duration = Duration::from_mins(10);
/// Address space of a run, KiB.
const MEMORY: u64 = 4 << 20;
/// Time for all cases where no number of cases is given.
const IN_ALL: Duration = Duration::from_secs(20);

/// How a run ended.
struct Run {
    code: Option<i32>,
    signal: Option<i32>,
    errors: String,
    spent: Duration,
}

impl Run {
    /// Runs the program in the folder of a scene.
    fn of(arguments: &[String], folder: &Path) -> Self {
        let program = assert_cmd::cargo::cargo_bin!("fredholm");
        let limits = format!("ulimit -v {MEMORY}; ulimit -t {SECONDS}; ulimit -c 0; exec \"$@\"");
        let errors = folder.join("stderr.txt");
        let started = Instant::now();
        let mut child = Command::new("sh")
            .args(["-c", &limits, "sh"])
            .arg(program)
            .args(arguments)
            .current_dir(folder)
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(File::create(&errors).unwrap())
            .spawn()
            .unwrap();
        let status = loop {
            if let Some(status) = child.try_wait().unwrap() {
                break status;
            }
            if started.elapsed() > MOST_ELAPSED {
                child.kill().unwrap();
            }
            std::thread::sleep(Duration::from_millis(5));
        };
        let errors = String::from_utf8_lossy(&fs::read(errors).unwrap()).into_owned();
        Self { code: status.code(), signal: status.signal(), errors, spent: started.elapsed() }
    }

    /// What is wrong with how it ended.
    fn fault(&self) -> Option<String> {
        if let Some(signal) = self.signal {
            return Some(format!("signal {signal} after {:.1} s", self.spent.as_secs_f64()));
        }
        if self.errors.contains("panicked") {
            return Some("panicked".to_owned());
        }
        match self.code {
            // Generated files lie where the scenes say, and the disc is writable: 5 would be wrong.
            Some(0 | 3 | 6) => None,
            Some(2 | 4) => {
                (!self.says_what_to_do()).then(|| "a refusal that does not say what to do".to_owned())
            }
            code => Some(format!("exit code {code:?}")),
        }
    }

    /// A refusal says what is wrong and, behind a semicolon or on a line of its own, what to do.
    fn says_what_to_do(&self) -> bool {
        let message = self.message();
        message.contains("\n  help: ") || message.contains("; ")
    }

    /// Whether the time that it was given has ended it.
    fn is_out_of_time(&self) -> bool {
        self.code == Some(3) && self.errors.contains("the time limit of")
    }

    /// The message of a refusal.
    fn message(&self) -> &str {
        self.errors.find("error: ").map_or("", |start| self.errors[start..].trim_end())
    }
}

#[test]
fn random_scenes_are_answered_or_refused() {
    let (asked, started) = (number("FREDHOLM_CASES"), Instant::now());
    let (mut faults, mut count, mut answered, mut slowest) = (vec![], 0, 0, Duration::ZERO);
    let mut late = 0;
    while asked.map_or(started.elapsed() < IN_ALL, |asked| count < asked) {
        let seed = first() + count;
        count += 1;
        let (case, folder) = (Case::random(seed), tempfile::tempdir().unwrap());
        case.files.write(folder.path()).unwrap();
        let given = ["--time-limit", TIME_LIMIT].map(str::to_owned);
        let run = Run::of(&[&case.arguments[..], &given].concat(), folder.path());
        late += u64::from(run.is_out_of_time());
        answered += usize::from(run.code == Some(0));
        slowest = slowest.max(run.spent);
        if let Some(fault) = run.fault() {
            let line = case.arguments.join(" ");
            let last = run.errors.lines().rev().take(6).collect::<Vec<_>>();
            let last: Vec<&str> = last.into_iter().rev().collect();
            let found = format!("case {seed}: {fault}\n  fredholm {line}\n  {}", last.join("\n  "));
            println!("{found}");
            faults.push(found);
            if let Some(keep) = keep() {
                let kept = keep.join(format!("case{seed}"));
                case.files.write(&kept).unwrap();
                fs::write(kept.join("command.txt"), format!("{line}\n")).unwrap();
                fs::write(kept.join("stderr.txt"), &run.errors).unwrap();
            }
        }
        if asked.is_some() {
            let spent = run.spent.as_secs_f64();
            println!("case {seed}: code {:?}, {spent:.1} s: {}", run.code, case.arguments.join(" "));
            if let Some(2 | 4) = run.code {
                println!("{}", run.message());
            }
        }
    }
    println!(
        "{count} cases, {answered} answered, {late} out of time, {} faults, slowest {slowest:.1?}",
        faults.len()
    );
    assert!(asked.is_none() || 20 * late <= count, "{late} of {count} cases take longer than {TIME_LIMIT}");
    assert!(faults.is_empty(), "{} of {count} cases:\n{}", faults.len(), faults.join("\n"));
    assert!(2 * answered as u64 > count, "only {answered} of {count} cases are answered");
}

/// What was found once: a folder each, as FREDHOLM_KEEP keeps them.
#[test]
fn what_was_found_stays_mended() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/robustness/finds");
    let mut finds: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    finds.sort();
    assert!(!finds.is_empty());
    for find in finds {
        let (copy, mut arguments) = (tempfile::tempdir().unwrap(), vec![]);
        for file in fs::read_dir(&find).unwrap().map(|entry| entry.unwrap().path()) {
            let name = file.file_name().unwrap();
            fs::copy(&file, copy.path().join(name)).unwrap();
            if name == "command.txt" {
                let line = fs::read_to_string(&file).unwrap();
                arguments = line.split_whitespace().map(str::to_owned).collect();
            }
        }
        let run = Run::of(&arguments, copy.path());
        let fault = run.fault();
        assert!(fault.is_none(), "{}: {fault:?}\n{}", find.display(), run.errors);
    }
}
