"""Runs a command that must print the lines of a table: expect.py TABLE COMMAND...; of one PART, its lines, when the
command's last word is one. Ends with 77 when the processor lacks an instruction."""
import signal
import subprocess
import sys

table, *command = sys.argv[1:]
with open(table) as file:
    expected = [line.rstrip() for line in file if not line.startswith("#") and line.strip()]
parts = {line.split()[1] for line in expected}
if command[-1] in parts:
    expected = [line for line in expected if line.split()[1] == command[-1]]

done = subprocess.run(command, stdout=subprocess.PIPE, text=True)
if done.returncode == -signal.SIGILL:
    print(f"{command}: not on this processor")
    sys.exit(77)
found = [line.rstrip() for line in done.stdout.splitlines()]
print("\n".join(found))
if done.returncode != 0:
    sys.exit(f"{command}: ended with {done.returncode}")
if not expected or expected != found:
    sys.exit("\n".join([f"{table} has others; its head says what to do:"] + expected))
