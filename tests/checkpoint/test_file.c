// The file of a checkpoint: written contents are read back, and only those.
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <signal.h>
#include <unistd.h>

#include "check.h"
#include "checkpoint/file.h"

enum { AREAS = 3, TABLE = 128, LINE = 32 };

static const ob_checkpoint_rule rules[AREAS] = { { "digits", 1, 0, 100 },
						 { "numbers", 8, 0, 1000 },
						 { "nothing", 4, 0, 10 } };

static char folder[] = "/tmp/test-checkpoint-XXXXXX";

static const char *path_of(const char *name)
{
	static char path[256];
	snprintf(path, sizeof path, "%s/%s", folder, name);
	return path;
}

static void fill(ob_checkpoint_file *f, uint64_t numbers)
{
	CHECK(ob_checkpoint_plan(f, rules, AREAS, (uint64_t[AREAS]){ 9, numbers, 0 }, "1.2 (a test)", NULL));
	memcpy(f->area[0].at, "123456789", 9);
	for (uint64_t i = 0; i < numbers; i++)
		((uint64_t *)f->area[1].at)[i] = i * i;
	ob_checkpoint_seal(f);
}

// The check value of CRC-64/XZ in the catalogue of parametrised CRC algorithms (Cook).
static void test_checksum(void)
{
	ob_checkpoint_file f = { 0 };
	uint64_t sum;
	fill(&f, 5);
	memcpy(&sum, f.bytes + TABLE + 24, sizeof sum);
	CHECK(sum == 0x995dc9bbdf1939fa);
	ob_checkpoint_finish(&f);
}

static void test_there_and_back(void)
{
	ob_checkpoint_file f = { 0 }, back = { 0 };
	ob_error e = { "" };
	for (uint64_t n = 0; n < 1000; n = 3 * n + 1) { // into the same memory, larger and larger
		fill(&f, n);
		CHECK(f.size % 64 == 0 && (uintptr_t)f.area[1].at % 64 == 0);
		CHECK(ob_checkpoint_write(&f, path_of("a"), &e));
		CHECK(ob_checkpoint_read(&back, rules, AREAS, path_of("a"), &e));
		CHECK(back.size == f.size && !memcmp(back.bytes, f.bytes, f.size) &&
		      !strcmp(back.program, "1.2 (a test)"));
		CHECK(back.area[0].count == 9 && back.area[1].count == n && back.area[2].count == 0);
		CHECK(n < 3 || ((uint64_t *)back.area[1].at)[n - 1] == (n - 1) * (n - 1));
		CHECK(access(path_of("a.part"), F_OK) != 0);
	}
	ob_checkpoint_finish(&f);
	ob_checkpoint_finish(&back);
}

// Every byte has a checksum, and none may be missing or added.
static void test_every_byte(void)
{
	ob_checkpoint_file f = { 0 }, back = { 0 };
	fill(&f, 7);
	char *bytes = malloc(f.size + 1);
	memcpy(bytes, f.bytes, f.size);
	bytes[f.size] = 0;
	CHECK(ob_checkpoint_parse(&back, rules, AREAS, bytes, f.size, "x", NULL));
	for (size_t i = 0; i < f.size; i++)
		for (int bit = 0; bit < 8; bit++) {
			bytes[i] ^= (char)(1 << bit);
			CHECK(!ob_checkpoint_parse(&back, rules, AREAS, bytes, f.size, "x", NULL));
			bytes[i] ^= (char)(1 << bit);
		}
	for (size_t n = 0; n <= f.size + 1; n++)
		CHECK(ob_checkpoint_parse(&back, rules, AREAS, bytes, n, "x", NULL) == (n == f.size));
	free(bytes);
	ob_checkpoint_finish(&f);
	ob_checkpoint_finish(&back);
}

static bool refused(const char *bytes, size_t size, const char *saying)
{
	ob_checkpoint_file f = { 0 };
	ob_error e = { "" };
	bool read = ob_checkpoint_parse(&f, rules, AREAS, bytes, size, "name", &e);
	ob_checkpoint_finish(&f);
	if (read || strncmp(e.text, "name: ", 6) != 0 || !strstr(e.text, saying))
		printf("%d, \"%s\"\n", read, e.text);
	return !read && strncmp(e.text, "name: ", 6) == 0 && strstr(e.text, saying);
}

static void test_foreign(void)
{
	ob_checkpoint_file f = { 0 };
	fill(&f, 7);
	char *b = f.bytes;
	CHECK(refused("", 0, "no checkpoint of obsim") && refused("OBSIMCK1", 8, "no checkpoint of obsim"));
	char order[4] = { b[11], b[10], b[9], b[8] };
	char kept[4];
	memcpy(kept, b + 8, 4);
	memcpy(b + 8, order, 4);
	CHECK(refused(b, f.size, "other byte order"));
	memcpy(b + 8, kept, 4);
	b[12] = 77;
	memcpy(b + 24, "9\033[2J\n", 7);
	CHECK(refused(b, f.size, "version 77") && refused(b, f.size, "resume it with obsim 9"));
	ob_checkpoint_finish(&f);
}

// A failed write leaves the old file, and nothing beside it.
static void test_failed_writes(void)
{
	ob_checkpoint_file f = { 0 }, back = { 0 };
	ob_error e = { "" };
	struct rlimit before, little = { 200, 200 };
	fill(&f, 7);
	CHECK(ob_checkpoint_write(&f, path_of("b"), &e));
	signal(SIGXFSZ, SIG_IGN);
	getrlimit(RLIMIT_FSIZE, &before);
	little.rlim_max = before.rlim_max;
	setrlimit(RLIMIT_FSIZE, &little);
	CHECK(!ob_checkpoint_write(&f, path_of("b"), &e) && strstr(e.text, "File too large"));
	setrlimit(RLIMIT_FSIZE, &before);
	CHECK(access(path_of("b.part"), F_OK) != 0);
	CHECK(ob_checkpoint_read(&back, rules, AREAS, path_of("b"), &e));

	int other = open(path_of("b.part"), O_RDWR | O_CREAT, 0600);
	CHECK(flock(other, LOCK_EX) == 0);
	CHECK(!ob_checkpoint_write(&f, path_of("b"), &e) && strstr(e.text, "another run writes it"));
	CHECK(access(path_of("b.part"), F_OK) == 0); // it is another's
	close(other);
	CHECK(ob_checkpoint_write(&f, path_of("b"), &e)); // a killed run's leftover is no obstacle
	CHECK(!ob_checkpoint_write(&f, path_of("no/folder"), &e) && strstr(e.text, "No such file"));

	CHECK(symlink("b", path_of("link")) == 0);
	fill(&f, 11);
	CHECK(ob_checkpoint_write(&f, path_of("link"), &e)); // replaces the link's target
	struct stat s;
	CHECK(lstat(path_of("link"), &s) == 0 && S_ISLNK(s.st_mode));
	CHECK(ob_checkpoint_read(&back, rules, AREAS, path_of("b"), &e) && back.area[1].count == 11);
	CHECK(symlink("/etc/hostname", path_of("c.part")) == 0);
	CHECK(!ob_checkpoint_write(&f, path_of("c"), &e)); // a link that waits there is not followed
	ob_checkpoint_finish(&f);
	ob_checkpoint_finish(&back);
}

int main(void)
{
	if (!mkdtemp(folder))
		return 1;
	test_checksum();
	test_there_and_back();
	test_every_byte();
	test_foreign();
	test_failed_writes();
	static const char *const left[] = { "a", "b", "link", "c.part" };
	for (size_t i = 0; i < sizeof left / sizeof *left; i++)
		unlink(path_of(left[i]));
	CHECK(rmdir(folder) == 0);
	return check_end();
}
