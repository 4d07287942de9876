//! A Slurm of one host for the length of a test: own key, ports, spool and configuration in a temporary folder.
//!
//! Where Slurm is not installed, Debian's packages are unpacked below `target/tmp`, not installed: nothing is left in
//! the system.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tempfile::TempDir;

/// Longest wait for anything; the machine may be busy.
const PATIENCE: Duration = Duration::from_secs(120);

pub struct Slurm {
    folder: TempDir,
    environment: Vec<(&'static str, OsString)>,
    /// In the order in which they were started.
    daemons: Vec<Child>,
}

impl Slurm {
    /// Starts munged, slurmctld and slurmd and waits until jobs can be submitted.
    ///
    /// # Errors
    /// Why it cannot be had here.
    pub fn start() -> Result<Slurm, String> {
        if said(Command::new("id").arg("-u"))?.trim() != "0" {
            return Err("the daemons of Slurm want to be started by root".into());
        }
        let places = Places::find()?;
        let folder =
            tempfile::Builder::new().prefix("slurm-").tempdir_in("/tmp").map_err(|e| e.to_string())?;
        let here = folder.path();
        for name in ["munge", "state", "spool", "log"] {
            std::fs::create_dir(here.join(name)).map_err(|e| e.to_string())?;
        }
        let configuration = here.join("slurm.conf");
        std::fs::write(&configuration, places.configuration(here)).map_err(|e| e.to_string())?;
        // The key only has to be the same for all on this host.
        let key: Vec<u8> = (0..64_u8).map(|k| k.wrapping_mul(37) ^ std::process::id() as u8).collect();
        std::fs::write(here.join("munge/key"), key).map_err(|e| e.to_string())?;
        said(Command::new("chmod").arg("600").arg(here.join("munge/key")))?;

        let environment = vec![
            ("PATH", joined(places.programs.iter().cloned(), "PATH")),
            ("LD_LIBRARY_PATH", joined(places.libraries.iter().cloned(), "LD_LIBRARY_PATH")),
            ("SLURM_CONF", configuration.into_os_string()),
        ];
        let mut slurm = Slurm { folder, environment, daemons: Vec::new() };
        let here = slurm.folder.path().to_path_buf();
        let option = |name: &str, file: &str| format!("--{name}={}", here.join("munge").join(file).display());
        let munge = [
            "--foreground".to_string(),
            "--force".to_string(),
            option("key-file", "key"),
            option("socket", "socket"),
            option("pid-file", "pid"),
            option("log-file", "log"),
            option("seed-file", "seed"),
        ];
        slurm.daemon("munged", &places.program("munged")?, &munge);
        slurm.until("munged listens", |_| here.join("munge/socket").exists());
        slurm.daemon("slurmctld", &places.program("slurmctld")?, &["-D".to_string()]);
        let mut node = vec!["-D".to_string(), "-N".to_string(), "localhost".to_string()];
        if let Ok(step) = places.program("slurmstepd") {
            node.extend(["-d".to_string(), step.display().to_string()]);
        }
        slurm.daemon("slurmd", &places.program("slurmd")?, &node);
        slurm.until("the node is idle", |slurm| {
            said(slurm.command("sinfo").args(["--noheader", "--format=%t"]))
                .is_ok_and(|state| state.trim() == "idle")
        });
        Ok(slurm)
    }

    fn daemon(&mut self, name: &str, program: &Path, arguments: &[String]) {
        let log = std::fs::File::create(self.folder.path().join("log").join(name)).unwrap();
        let mut command = Command::new(program);
        command.args(arguments).envs(self.environment.iter().cloned()).stdin(Stdio::null());
        let started = command.stdout(log.try_clone().unwrap()).stderr(log).spawn();
        self.daemons.push(started.unwrap_or_else(|error| panic!("{}: {error}", program.display())));
    }

    /// A command that talks to this Slurm.
    pub fn command(&self, program: impl AsRef<std::ffi::OsStr>) -> Command {
        let mut command = Command::new("env");
        // Looked up on the path of the command, not on that of the test.
        command.envs(self.environment.iter().cloned()).arg(program).stdin(Stdio::null());
        command
    }

    /// What a command says; it must succeed.
    pub fn say(&self, program: impl AsRef<std::ffi::OsStr>, arguments: &[&str]) -> String {
        said(self.command(program).args(arguments)).unwrap_or_else(|error| panic!("{error}\n{}", self.logs()))
    }

    /// Waits until something holds.
    pub fn until(&self, what: &str, mut holds: impl FnMut(&Slurm) -> bool) {
        let begun = Instant::now();
        while !holds(self) {
            assert!(begun.elapsed() < PATIENCE, "in vain: {what}\n{}", self.logs());
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Waits until no job waits or runs.
    pub fn until_empty(&self) {
        self.until("the queue is empty", |slurm| slurm.say("squeue", &["--noheader"]).is_empty());
    }

    /// The ends of the daemons' logs.
    fn logs(&self) -> String {
        let names = ["munged", "slurmctld", "slurmd"];
        let end = |name: &&str| {
            let text = std::fs::read_to_string(self.folder.path().join("log").join(name)).unwrap_or_default();
            let lines: Vec<&str> = text.lines().collect();
            format!("--- {name}\n{}\n", lines[lines.len().saturating_sub(20)..].join("\n"))
        };
        names.iter().map(end).collect()
    }
}

impl Drop for Slurm {
    /// Ends all jobs and daemons, whatever state they are in.
    fn drop(&mut self) {
        let _ = said(self.command("scancel").arg("--user=0"));
        let begun = Instant::now();
        while begun.elapsed() < Duration::from_secs(15)
            && said(self.command("squeue").arg("--noheader")).is_ok_and(|queue| !queue.is_empty())
        {
            std::thread::sleep(Duration::from_millis(100));
        }
        for daemon in self.daemons.iter_mut().rev() {
            let _ = said(Command::new("kill").arg(daemon.id().to_string()));
            let begun = Instant::now();
            while begun.elapsed() < Duration::from_secs(10) && matches!(daemon.try_wait(), Ok(None)) {
                std::thread::sleep(Duration::from_millis(20));
            }
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
        // Steps outlive the daemon that started them. All that belongs to this Slurm carries its configuration.
        let mark = format!("SLURM_CONF={}\0", self.folder.path().join("slurm.conf").display());
        for process in processes().filter(|process| *process != std::process::id()) {
            let environment = std::fs::read(format!("/proc/{process}/environ")).unwrap_or_default();
            if environment.windows(mark.len()).any(|part| part == mark.as_bytes()) {
                let _ = said(Command::new("kill").args(["-9", &process.to_string()]));
            }
        }
    }
}

/// Numbers of all processes.
pub fn processes() -> impl Iterator<Item = u32> {
    let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().to_str()?.parse().ok())
}

/// What a command prints, or why it failed.
fn said(command: &mut Command) -> Result<String, String> {
    let output = command.output().map_err(|error| format!("{}: {error}", command.get_program().display()))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let complaint = String::from_utf8_lossy(&output.stderr).trim().replace('\n', "; ");
    Err(format!("{}: {complaint}", command.get_program().display()))
}

/// Folders, then what a variable of this process holds.
fn joined(folders: impl Iterator<Item = PathBuf>, variable: &str) -> OsString {
    let inherited = std::env::var_os(variable).unwrap_or_default();
    let all = folders.chain(std::env::split_paths(&inherited).filter(|path| !path.as_os_str().is_empty()));
    std::env::join_paths(all).unwrap()
}

/// Where programs, libraries and plugins of Slurm are.
struct Places {
    programs: Vec<PathBuf>,
    libraries: Vec<PathBuf>,
    /// None for those of the system.
    plugins: Option<PathBuf>,
}

impl Places {
    fn find() -> Result<Places, String> {
        let system = Places {
            programs: vec!["/usr/sbin".into(), "/usr/bin".into(), "/sbin".into()],
            libraries: Vec::new(),
            plugins: None,
        };
        if ["munged", "slurmctld", "slurmd", "sbatch", "squeue"]
            .iter()
            .all(|name| system.program(name).is_ok())
        {
            return Ok(system);
        }
        let root = unpacked()?;
        let mut programs = vec![root.join("usr/sbin"), root.join("usr/bin")];
        programs.extend(system.programs);
        let libraries = std::fs::read_dir(root.join("usr/lib")).map_err(|e| e.to_string())?;
        let plugins = libraries
            .flatten()
            .map(|entry| entry.path().join("slurm-wlm"))
            .find(|path| path.is_dir())
            .ok_or("the packages of Slurm hold no plugins")?;
        let libraries = vec![plugins.parent().unwrap_or(&plugins).to_path_buf(), plugins.clone()];
        Ok(Places { programs, libraries, plugins: Some(plugins) })
    }

    /// A program, also under the name it has in the package before Debian's alternatives are set.
    fn program(&self, name: &str) -> Result<PathBuf, String> {
        self.programs
            .iter()
            .flat_map(|folder| [folder.join(name), folder.join(format!("{name}-wlm"))])
            .find(|path| path.is_file())
            .ok_or_else(|| format!("{name} is not there"))
    }

    fn configuration(&self, here: &Path) -> String {
        // Two ports that are free now.
        let listeners = [0, 1].map(|_| std::net::TcpListener::bind("127.0.0.1:0").unwrap());
        let [control, node] = listeners.map(|listener| listener.local_addr().unwrap().port());
        let here = here.display();
        let plugins =
            self.plugins.as_ref().map_or(String::new(), |path| format!("PluginDir={}\n", path.display()));
        // Credentials that live for 10 s let a task that goes back to the queue start again after 10 s; the node has
        // three processors whatever the host has, so that three blocks run at once.
        format!(
            "\
ClusterName=test
SlurmctldHost=localhost(127.0.0.1)
SlurmUser=root
SlurmctldPort={control}
SlurmdPort={node}
AuthType=auth/munge
AuthInfo=socket={here}/munge/socket,cred_expire=10
StateSaveLocation={here}/state
SlurmdSpoolDir={here}/spool
SlurmctldPidFile={here}/slurmctld.pid
SlurmdPidFile={here}/slurmd.pid
PlugStackConfig=/dev/null
{plugins}ProctrackType=proctrack/linuxproc
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=0
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=5
NodeName=localhost NodeAddr=127.0.0.1 CPUs=3 RealMemory=1000 State=UNKNOWN
PartitionName=main Nodes=localhost Default=YES MaxTime=INFINITE State=UP
"
        )
    }
}

/// Debian's packages and what they need beyond what is installed, unpacked; once for all tests of a build folder.
fn unpacked() -> Result<PathBuf, String> {
    let store = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let ready = store.join("slurm");
    if ready.exists() {
        return Ok(ready);
    }
    std::fs::create_dir_all(store).map_err(|e| e.to_string())?;
    let work = tempfile::tempdir_in(store).map_err(|e| e.to_string())?;
    for name in ["archives/partial", "lists/partial", "root"] {
        std::fs::create_dir_all(work.path().join(name)).map_err(|e| e.to_string())?;
    }
    let apt = |own_lists: bool, arguments: &[&str]| {
        let mut command = Command::new("apt-get");
        let mut options = vec![
            format!("Dir::Cache::archives={}", work.path().join("archives").display()),
            "Dir::Cache::pkgcache=".into(),
            "Dir::Cache::srcpkgcache=".into(),
            "Debug::NoLocking=1".into(),
            "APT::Sandbox::User=root".into(),
            "Acquire::Retries=0".into(),
            "Acquire::http::Timeout=20".into(),
            "Acquire::https::Timeout=20".into(),
        ];
        if own_lists {
            options.push(format!("Dir::State::lists={}", work.path().join("lists").display()));
        }
        for option in options {
            command.args(["-o".to_string(), option]);
        }
        said(command.arg("-qq").args(arguments).env("DEBIAN_FRONTEND", "noninteractive").stdin(Stdio::null()))
    };
    let install = ["install", "--yes", "--no-install-recommends", "--download-only", "slurm-wlm", "munge"];
    apt(false, &install)
        .or_else(|_| apt(true, &["update"]).and_then(|_| apt(true, &install)))
        .map_err(|error| format!("the packages slurm-wlm and munge cannot be had: {error}"))?;
    let archives = std::fs::read_dir(work.path().join("archives")).map_err(|e| e.to_string())?;
    for package in archives.flatten().map(|entry| entry.path()) {
        if package.extension().is_some_and(|extension| extension == "deb") {
            said(Command::new("dpkg").arg("-x").args([&package, &work.path().join("root")]))?;
        }
    }
    // Another test may have been faster.
    let renamed = std::fs::rename(work.path().join("root"), &ready);
    if ready.exists() { Ok(ready) } else { Err(format!("{}: {renamed:?}", ready.display())) }
}
