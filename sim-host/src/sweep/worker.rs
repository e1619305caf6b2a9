//! A process that computes units.

use super::claim::now_unix_s;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A process, distinguished from all others.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Worker {
    /// Name of its machine.
    pub host: String,
    /// Number of the process.
    pub pid: u32,
    /// Job of a batch system, such as "1234_5" of a Slurm array; null outside one.
    pub job: Option<String>,
    /// Start of its work, seconds since 1970 UTC.
    pub started_unix_s: u64,
    /// The table of processes to which `pid` belongs (of Linux: boot and process name space), as machines may have
    /// equal names; null where unknown.
    pub processes: Option<String>,
}

impl Worker {
    /// The current process.
    pub fn this() -> Self {
        let read = |path: &str| std::fs::read_to_string(path).ok().map(|text| text.trim().to_owned());
        let variable = |name: &str| std::env::var(name).ok().filter(|text| !text.is_empty());
        let space = || Some(std::fs::read_link("/proc/self/ns/pid").ok()?.display().to_string());
        let array =
            || Some(format!("{}_{}", variable("SLURM_ARRAY_JOB_ID")?, variable("SLURM_ARRAY_TASK_ID")?));
        let host = read("/proc/sys/kernel/hostname").or_else(|| variable("COMPUTERNAME"));
        Self {
            host: host.or_else(|| variable("HOSTNAME")).unwrap_or_else(|| "unknown".into()),
            pid: std::process::id(),
            job: array().or_else(|| variable("SLURM_JOB_ID")),
            started_unix_s: now_unix_s(),
            processes: read("/proc/sys/kernel/random/boot_id")
                .zip(space())
                .map(|(boot, space)| format!("{boot} {space}")),
        }
    }

    /// Whether it is known to have ended: its table of processes is that of `here`, and it is not in there, or as a
    /// process that has ended (Z) but is still in the table.
    pub(super) fn ended(&self, here: &Self) -> bool {
        let same = self.processes.is_some() && self.processes == here.processes;
        let stat = || std::fs::read_to_string(format!("/proc/{}/stat", self.pid));
        same && stat()
            .map_or(true, |stat| stat.rsplit_once(") ").is_some_and(|(_, rest)| rest.starts_with('Z')))
    }

    /// Machine and number, and the job if there is one: "node3:4711 (job 1234_5)".
    pub fn name(&self) -> String {
        let job = self.job.as_ref().map_or(String::new(), |job| format!(" (job {job})"));
        format!("{}:{}{job}", self.host, self.pid)
    }
}
