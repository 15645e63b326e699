"""Writes the manual page: docs/obsim.1, and from the table of settings those that it does not describe itself.

    manual.py OBSIM TEMPLATE PAGE
"""

import re
import subprocess
import sys

obsim, template, page = sys.argv[1:]
listed = subprocess.run([obsim, "run", "--set", "help"], capture_output=True, text=True, check=True).stdout
with open(template, encoding="utf-8") as f:
	text = f.read()
described = re.findall(r'^\.BR (\w+) "=', text, re.M)
table = {name: (form, words) for name, form, words in re.findall(r"^  (\w+)=(\S+)\s+(.*)", listed, re.M)}
if set(described) - set(table):
	sys.exit(f"{template}: there is no setting {', '.join(set(described) - set(table))}")
added = "".join(f'.TP\n.BR {name} "={form}"\n{words[0].upper()}{words[1:]}.\n' for name, (form, words) in table.items() if name not in described)
with open(page, "w", encoding="utf-8") as f:
	f.write(re.sub(r'^\.\\" settings without an entry .*\n', lambda _: added, text, flags=re.M))
