#include "lab/provenance.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/utsname.h>

#include "base/cpu.h"

static void find_processor(char *to, size_t room)
{
	char line[256];
	FILE *f = fopen("/proc/cpuinfo", "re");
	snprintf(to, room, "unknown processor");
	while (f && fgets(line, sizeof line, f)) {
		char *value = strstr(line, ": ");
		if (strncmp(line, "model name", 10) != 0 || !value)
			continue;
		snprintf(to, room, "%.*s", (int)strcspn(value + 2, "\n"), value + 2);
		break;
	}
	if (f)
		fclose(f);
}

void ob_provenance_machine(char *to, size_t room)
{
	char processor[96];
	struct utsname u = { 0 };
	int cores = ob_cpu_count();
	find_processor(processor, sizeof processor);
	uname(&u);
	snprintf(to, room, "%s, %d core%s, %.16s %.32s", processor, cores, cores == 1 ? "" : "s", u.sysname, u.release);
}

void ob_provenance_commit(const char *commit, char *to, size_t room)
{
	size_t n = strlen(commit);
	snprintf(to, room, "%s", commit);
	FILE *f =
		n == 0 || commit[n - 1] == '+' || strcmp(commit, "unknown") == 0 ? fopen("/proc/self/exe", "re") : NULL;
	if (!f)
		return;
	uint64_t hash = 0xcbf29ce484222325; // FNV-1a
	for (int c; (c = getc(f)) != EOF;)
		hash = (hash ^ (uint64_t)c) * 0x100000001b3;
	fclose(f);
	snprintf(to + strlen(to), room - strlen(to), "%s%08" PRIx32, n && commit[n - 1] == '+' ? "" : "+",
		 (uint32_t)(hash ^ hash >> 32));
}
