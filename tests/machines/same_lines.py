"""Runs two commands, their words parted by ';', that must print the same lines. Ends with 77 when the processor lacks an
instruction of one."""
import signal
import subprocess
import sys


def lines_of(command):
    done = subprocess.run(command.split(";"), stdout=subprocess.PIPE, text=True)
    if done.returncode == -signal.SIGILL:
        print(f"{command}: not on this processor")
        sys.exit(77)
    if done.returncode != 0:
        sys.exit(f"{command}: ended with {done.returncode}")
    return done.stdout.splitlines()


expected, found = (lines_of(command) for command in sys.argv[1:3])
print("\n".join(found))
if not expected:
    sys.exit("nothing was printed")
if expected != found:
    sys.exit("\n".join(["others were expected:"] + expected))
