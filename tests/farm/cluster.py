"""A Slurm of one controller and several nodes on this machine, in a folder and on ports of its own."""
import os
import pathlib
import signal
import socket
import subprocess
import time

from common import find, run

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol", "sinfo"]


def free_ports(count):
    taken = [socket.socket() for _ in range(count)]
    for one in taken:
        one.bind(("127.0.0.1", 0))
    ports = [one.getsockname()[1] for one in taken]
    for one in taken:
        one.close()
    return ports


def wait_for(what, happened, seconds=120):
    end = time.monotonic() + seconds
    while not happened():
        if time.monotonic() > end:
            raise AssertionError(f"waited {seconds} s for {what}")
        time.sleep(0.1)


class Cluster:
    def __init__(self, folder, nodes, array_size):
        self.folder, self.nodes, self.array_size = pathlib.Path(folder), nodes, array_size
        self.daemons, self.environment = {}, {}

    def __enter__(self):
        try:
            self.start()
        except BaseException:
            self.__exit__()
            raise
        return self

    def start(self):
        folder, user = self.folder, run(["id", "-un"]).stdout.strip()
        host = socket.gethostname().split(".")[0]
        ports = free_ports(1 + len(self.nodes))
        key = folder / "munge.key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        (folder / "state").mkdir()
        for node in self.nodes:
            (folder / f"spool.{node}").mkdir()
        lines = f"""
ClusterName=candela
SlurmctldHost={host}(127.0.0.1)
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={folder}/munge.socket,cred_expire=5
SlurmctldPort={ports[0]}
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool.%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core_Memory
SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
SwitchType=switch/none
MpiDefault=none
SlurmdParameters=config_overrides
SlurmdTimeout=5
SlurmctldTimeout=5
KillWait=1
MinJobAge=600
ReturnToService=0
MaxArraySize={self.array_size}
"""
        for node, port in zip(self.nodes, ports[1:]):
            lines += f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={port} CPUs=4 RealMemory=4000\n"
        lines += f"PartitionName=all Nodes={','.join(self.nodes)} Default=YES MaxTime=INFINITE State=UP\n"
        conf = folder / "slurm.conf"
        conf.write_text(lines)
        self.environment = {**os.environ, "SLURM_CONF": str(conf)}
        self.daemon("munged", "-F", "--force", f"--key-file={key}", f"--socket={folder}/munge.socket",
                    f"--pid-file={folder}/munged.pid", f"--log-file={folder}/munged.log", f"--seed-file={folder}/munge.seed")
        wait_for("munged", lambda: (folder / "munge.socket").exists(), 20)
        self.daemon("slurmctld", "-D", "-c", "-f", conf)
        for node in self.nodes:
            self.daemon("slurmd", "-D", "-N", node, "-f", conf, name=node)
        wait_for("the nodes", lambda: self("sinfo", "-h", "-t", "idle", "-o", "%D").strip() == str(len(self.nodes)), 60)

    def daemon(self, program, *words, name=None):
        with open(self.folder / f"{name or program}.out", "wb") as log:
            self.daemons[name or program] = subprocess.Popen(
                [find(program), *map(str, words)], stdin=subprocess.DEVNULL, stdout=log, stderr=log,
                env=self.environment, start_new_session=True)

    def __call__(self, program, *words):
        return run([program, *words], env=self.environment).stdout

    def kill_daemon(self, name):
        """As a machine that loses power, but for what runs on it."""
        self.daemons[name].kill()
        self.daemons[name].wait()

    def jobs(self):
        return self("squeue", "-h", "-o", "%i").split()

    def of_ours(self):
        """Processes that have this cluster in their environment: daemons that start others leave no other trace."""
        mine = f"SLURM_CONF={self.folder}/slurm.conf".encode()
        for entry in pathlib.Path("/proc").iterdir():
            try:
                if entry.name.isdigit() and mine in (entry / "environ").read_bytes().split(b"\0"):
                    yield int(entry.name)
            except OSError:
                pass

    def __exit__(self, *_):
        for daemon in self.daemons.values():
            daemon.kill()
            daemon.wait()
        for process in list(self.of_ours()):
            if process != os.getpid():
                try:
                    os.kill(process, signal.SIGKILL)
                except ProcessLookupError:
                    pass

    def logs(self):
        return "".join(f"== {path.name}\n{path.read_text(errors='replace')[-3000:]}\n"
                       for path in sorted(self.folder.glob("*.out")))
