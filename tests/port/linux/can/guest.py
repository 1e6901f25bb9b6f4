"""Runs a script in a kernel of its own: user-mode Linux on the files of this machine, with CAN.

guest.py FOLDER SCRIPT ARGS...: boots, makes vcan0, runs `python3 SCRIPT ARGS...`, prints what it said and ends with its
exit code. The folder is the only place that the guest can write to; it is made anew. What does not come up, or does not
come to an end, is a failure: 125.
"""
import os
import pathlib
import shlex
import shutil
import subprocess
import sys

PATIENCE_S = 120
FAILED = 125
INIT = """#!/bin/sh
export PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/run PYTHONDONTWRITEBYTECODE=1
mount -t proc proc /proc; mount -t sysfs sys /sys; mount -t tmpfs tmpfs /run; mount -t tmpfs tmpfs /dev/shm 2>/dev/null
mkdir /run/out; mount -t hostfs -o {folder} hostfs /run/out
for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan net/sched/sch_tbf; do
  busybox insmod /usr/lib/uml/modules/$(uname -r)/kernel/$module.ko || echo "no module $module"
done >/run/out/said 2>&1
ip link set lo up; ip link add vcan0 type vcan; ip link set vcan0 mtu 72; ip link set vcan0 up
cd /run
/usr/bin/python3 -B {command} >>/run/out/said 2>&1
echo $? >/run/out/code
busybox poweroff -f
"""


def main(folder, *command):
    folder = pathlib.Path(folder).absolute()
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    init = folder / "init"
    init.write_text(INIT.format(folder=shlex.quote(str(folder)), command=shlex.join(command)))
    init.chmod(0o755)
    kernel = ["linux.uml", "mem=512M", "umid=guest", f"uml_dir={folder}/", "root=/dev/root", "rootfstype=hostfs",
              "rootflags=/", "ro", f"init={init}", "con=null", "con0=null,fd:1", "quiet", "panic=1"]
    # Its memory is a file that is mapped to be executed; /dev/shm is where it looks first.
    with open(folder / "console", "wb") as console:
        try:
            subprocess.run(kernel, stdin=subprocess.DEVNULL, stdout=console, stderr=subprocess.STDOUT,
                           timeout=PATIENCE_S, check=False)
        except (OSError, subprocess.TimeoutExpired) as error:
            print(f"guest: {error}")
    for name in ("said", "code"):
        if not (folder / name).exists():
            print(f"guest: it left no '{name}'; its console:")
            print((folder / "console").read_text(errors="replace")[-4000:])
            return FAILED
    print((folder / "said").read_text(errors="replace"), end="")
    return int((folder / "code").read_text())


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
