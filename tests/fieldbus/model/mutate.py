"""mutate.py IN OUT FROM TO: copies a source with one piece of text changed, which must be there exactly once."""
import pathlib
import sys

source, target, old, new = sys.argv[1:]
text = pathlib.Path(source).read_text()
if text.count(old) != 1:
    sys.exit(f"{source}: {old!r} is there {text.count(old)} times; mend the mutant")
path = pathlib.Path(target)
path.parent.mkdir(parents=True, exist_ok=True)
path.write_text(text.replace(old, new))
