"""What the program says, to hold the module against."""
import json
import pathlib
import subprocess

import ukemi

BUILD = pathlib.Path(ukemi.__file__).parent
# The clock, the folder and the reading of files: no part of a result.
ASIDE = ("provenance", "files", "warnings", "time_s", "seconds", "force_noise", "modules", "force_logs")


def program(folder, *arguments):
    """summary.json of the program's verb."""
    subprocess.run([BUILD / "ukemi", *map(str, arguments), "-o", folder, "--quiet", "--no-report"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    return json.loads((folder / "summary.json").read_text())


def numbers(summary):
    """A summary without what stands aside."""
    if isinstance(summary, dict):
        return {k: numbers(v) for k, v in summary.items() if not any(word in k for word in ASIDE)}
    return [numbers(v) for v in summary] if isinstance(summary, list) else summary
