#include "checkpoint/file.h"

#include <assert.h>
#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <libgen.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"

static const char magic[8] = { 'O', 'B', 'S', 'I', 'M', 'C', 'K', '1' };
static const uint32_t byte_order = 0x01020304;
enum { BORDER = 64 };

// The first four fields and the program have the same place in all versions.
typedef struct header {
	char magic[8];
	uint32_t byte_order;
	uint32_t version;
	uint64_t bytes; // size of the whole file
	char program[64]; // text that ends with a 0
	uint32_t areas;
	uint32_t zero[7];
	uint64_t checksum; // over header and table, with 0 here
} header;

typedef struct line {
	uint32_t element, zero;
	uint64_t count, offset, checksum;
} line;

typedef struct start { // the start of the file
	header h;
	line l[OB_CHECKPOINT_AREAS_MAX]; // a file has as many as it has areas
} start;

static size_t start_bytes(uint32_t areas)
{
	return sizeof(header) + areas * sizeof(line);
}

static_assert(sizeof(header) == 128 && sizeof(line) == 32, "the file's layout");

// ---- checksum

// Eight bytes at a time (Kounavis and Berry 2005, "slicing by 8").
static void fill_tables(uint64_t table[8][256])
{
	for (unsigned i = 0; i < 256; i++) {
		uint64_t c = i;
		for (int k = 0; k < 8; k++)
			c = c >> 1 ^ (c & 1 ? 0xc96c5795d7870f42u : 0);
		table[0][i] = c;
	}
	for (int k = 1; k < 8; k++)
		for (unsigned i = 0; i < 256; i++)
			table[k][i] = table[k - 1][i] >> 8 ^ table[0][table[k - 1][i] & 0xff];
}

static uint64_t crc64(uint64_t table[8][256], const void *bytes, size_t n)
{
	const unsigned char *b = bytes;
	uint64_t c = ~UINT64_C(0);
	for (; n >= 8; n -= 8, b += 8) {
		uint64_t low = 0;
		for (int i = 0; i < 8; i++)
			low |= (uint64_t)b[i] << 8 * i;
		low ^= c;
		c = 0;
		for (int i = 0; i < 8; i++)
			c ^= table[7 - i][low >> 8 * i & 0xff];
	}
	for (; n > 0; n--, b++)
		c = c >> 8 ^ table[0][(c ^ *b) & 0xff];
	return ~c;
}

static uint64_t start_checksum(const start *s)
{
	uint64_t table[8][256];
	start copy = *s;
	fill_tables(table);
	copy.h.checksum = 0;
	return crc64(table, &copy, start_bytes(s->h.areas));
}

static void area_checksums(const ob_checkpoint_file *f, const start *s, uint64_t *out)
{
	uint64_t table[8][256];
	fill_tables(table);
	for (uint32_t i = 0; i < f->areas; i++)
		out[i] = crc64(table, f->area[i].at, s->l[i].element * s->l[i].count);
}

// ---- memory

// Makes room for so many bytes, and spare ones for larger files to come.
static bool make_room(ob_checkpoint_file *f, size_t size, size_t spare, ob_error *e)
{
	if (f->room < size) {
		free(f->bytes);
		f->bytes = aligned_alloc(BORDER, (size + spare + BORDER - 1) / BORDER * BORDER);
		f->room = f->bytes ? size + spare : 0;
	}
	f->size = f->bytes ? size : 0;
	return f->bytes || ob_fail(e, "no memory for a checkpoint of %zu bytes", size);
}

// Makes room for a file that is read, and comes from anybody.
static bool make_room_to_read(ob_checkpoint_file *f, size_t size, const char *name, ob_error *e)
{
	ob_error why;
	return (ob_budget_allows(size, &why) || ob_fail(e, "%s: %s", name, why.text)) && make_room(f, size, 0, e);
}

static uint64_t next_border(uint64_t at)
{
	return (at + BORDER - 1) / BORDER * BORDER;
}

// Points the areas to their places in the table.
static void set_areas(ob_checkpoint_file *f, const start *s)
{
	f->areas = s->h.areas;
	for (uint32_t i = 0; i < f->areas; i++)
		f->area[i] = (ob_checkpoint_area){ f->bytes + s->l[i].offset, s->l[i].count };
}

bool ob_checkpoint_plan(ob_checkpoint_file *f, const ob_checkpoint_rule *rule, uint32_t areas, const uint64_t *count,
			const char *program, ob_error *e)
{
	start s = { .h = { .byte_order = byte_order, .version = OB_CHECKPOINT_VERSION, .areas = areas } };
	uint64_t at = next_border(start_bytes(areas));
	for (uint32_t i = 0; i < areas; i++) {
		s.l[i] = (line){ .element = rule[i].element, .count = count[i], .offset = at };
		at = next_border(at + rule[i].element * count[i]);
	}
	if (at > OB_CHECKPOINT_BYTES_MAX)
		return ob_fail(e, "a checkpoint of %" PRIu64 " MiB: %" PRIu64 " MiB at most can be kept", at >> 20,
			       OB_CHECKPOINT_BYTES_MAX >> 20);
	if (!make_room(f, at, at / 4, e))
		return false;
	memcpy(s.h.magic, magic, sizeof magic);
	snprintf(s.h.program, sizeof s.h.program, "%s", program);
	memcpy(f->program, s.h.program, sizeof f->program);
	s.h.bytes = at;
	memcpy(f->bytes, &s, start_bytes(areas));
	set_areas(f, &s);
	uint64_t end = start_bytes(areas); // fills with zeros from the end of each part to the next border
	for (uint32_t i = 0; i <= areas; i++) {
		memset(f->bytes + end, 0, next_border(end) - end);
		end = i < areas ? s.l[i].offset + s.l[i].element * s.l[i].count : end;
	}
	return true;
}

void ob_checkpoint_finish(ob_checkpoint_file *f)
{
	free(f->bytes);
	*f = (ob_checkpoint_file){ 0 };
}

// ---- writing

// Opens the new file beside path, empty, for exclusive use. Returns < 0 and e on failure.
static int open_part(const char *part, ob_error *e)
{
	struct stat opened, named;
	int fd = open(part, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK, 0666);
	if (fd < 0) {
		ob_fail(e, "%s: %s", part, strerror(errno));
		return -1;
	}
	// an earlier holder of the lock may already have renamed the file
	bool own = fstat(fd, &opened) == 0 && S_ISREG(opened.st_mode) && flock(fd, LOCK_EX | LOCK_NB) == 0 &&
		   lstat(part, &named) == 0 && named.st_ino == opened.st_ino && named.st_dev == opened.st_dev;
	if (own && ftruncate(fd, 0) == 0)
		return fd;
	ob_fail(e, "%s: %s", part, own ? strerror(errno) : "another run writes it, or it is no file");
	close(fd);
	return -1;
}

static bool write_all(int fd, const char *bytes, size_t size)
{
	while (size > 0) {
		ssize_t n = write(fd, bytes, size);
		if (n < 0 && errno != EINTR)
			return false;
		bytes += n > 0 ? n : 0;
		size -= n > 0 ? (size_t)n : 0;
	}
	return true;
}

// Writes the new name to the disk, too. A folder that cannot be opened for that (no permission to list it) is no
// failure: the file is whole under either name.
static void sync_folder(const char *path)
{
	char copy[PATH_MAX];
	snprintf(copy, sizeof copy, "%s", path);
	int fd = open(dirname(copy), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd < 0)
		return;
	fsync(fd);
	close(fd);
}

void ob_checkpoint_seal(ob_checkpoint_file *f)
{
	uint64_t sum[OB_CHECKPOINT_AREAS_MAX];
	start s = { 0 };
	memcpy(&s, f->bytes, start_bytes(f->areas));
	area_checksums(f, &s, sum);
	for (uint32_t i = 0; i < f->areas; i++)
		s.l[i].checksum = sum[i];
	s.h.checksum = start_checksum(&s);
	memcpy(f->bytes, &s, start_bytes(f->areas));
}

bool ob_checkpoint_write(const ob_checkpoint_file *f, const char *path, ob_error *e)
{
	char real[PATH_MAX], part[PATH_MAX + 8];
	if (!realpath(path, real)) // replaces the target of a link, not the link
		snprintf(real, sizeof real, "%s", path);
	snprintf(part, sizeof part, "%s.part", real);
	int fd = open_part(part, e);
	if (fd < 0)
		return false;
	const char *failed = !write_all(fd, f->bytes, f->size) ? "write"
			     : fsync(fd) != 0                  ? "write"
			     : rename(part, real) != 0         ? "rename"
							       : NULL;
	if (failed) {
		ob_fail(e, "%s: cannot %s the checkpoint: %s", path, failed, strerror(errno));
		unlink(part);
	}
	close(fd);
	if (!failed)
		sync_folder(real);
	return !failed;
}

// ---- reading

// Copies one line of text from outside, without characters that could move a terminal's cursor.
static void copy_program(char to[64], const char *from)
{
	memset(to, 0, 64);
	for (int i = 0; i < 63 && from[i] >= ' ' && from[i] < 127; i++)
		to[i] = from[i];
}

static bool check_header(const header *h, size_t size, uint32_t areas, const char *name, ob_error *e)
{
	char program[64];
	copy_program(program, h->program);
	if (size < sizeof *h || memcmp(h->magic, magic, sizeof magic) != 0)
		return ob_fail(e, "%s: this is no checkpoint of obsim", name);
	if (h->byte_order != byte_order)
		return ob_fail(e, "%s: this checkpoint comes from a machine of the other byte order", name);
	if (h->version != OB_CHECKPOINT_VERSION)
		return ob_fail(e,
			       "%s: a checkpoint of version %" PRIu32
			       ", this program reads version %d: resume it with obsim %s",
			       name, h->version, OB_CHECKPOINT_VERSION, program);
	if (h->bytes != size)
		return ob_fail(e, "%s: this checkpoint is damaged: it has %zu bytes of %" PRIu64, name, size, h->bytes);
	if (h->areas != areas || size < start_bytes(areas))
		return ob_fail(e, "%s: this checkpoint is damaged: its table makes no sense", name);
	return true;
}

static bool line_makes_sense(const line *l, const ob_checkpoint_rule *rule, uint64_t at, size_t size)
{
	return l->element == rule->element && l->zero == 0 && l->count >= rule->least && l->count <= rule->most &&
	       l->offset == at && at <= size && l->count <= (size - at) / rule->element;
}

// Checks the start of a file of so many bytes.
static bool check_start(const start *s, size_t size, const ob_checkpoint_rule *rule, uint32_t areas, const char *name,
			ob_error *e)
{
	if (!check_header(&s->h, size, areas, name, e))
		return false;
	uint64_t at = next_border(start_bytes(areas));
	for (uint32_t i = 0; i < areas; i++) {
		if (!line_makes_sense(&s->l[i], &rule[i], at, size))
			return ob_fail(e, "%s: this checkpoint is damaged: its table makes no sense of the %s", name,
				       rule[i].name);
		at = next_border(at + s->l[i].element * s->l[i].count);
	}
	if (at != size || start_checksum(s) != s->h.checksum)
		return ob_fail(e, "%s: this checkpoint is damaged: the checksum of its table is wrong", name);
	return true;
}

// True if zeros follow from the end of a part to the next border.
static bool zeros_follow(const ob_checkpoint_file *f, uint64_t end)
{
	for (uint64_t at = end; at < next_border(end); at++)
		if (f->bytes[at])
			return false;
	return true;
}

// Checks the rest, once it is in memory.
static bool check_areas(ob_checkpoint_file *f, const start *s, const ob_checkpoint_rule *rule, const char *name,
			ob_error *e)
{
	uint64_t sum[OB_CHECKPOINT_AREAS_MAX];
	set_areas(f, s);
	copy_program(f->program, s->h.program);
	area_checksums(f, s, sum);
	if (!zeros_follow(f, start_bytes(f->areas)))
		return ob_fail(e, "%s: this checkpoint is damaged: there is something behind its table", name);
	for (uint32_t i = 0; i < f->areas; i++)
		if (sum[i] != s->l[i].checksum || !zeros_follow(f, s->l[i].offset + s->l[i].element * s->l[i].count))
			return ob_fail(e, "%s: this checkpoint is damaged: the checksum of its %s is wrong", name,
				       rule[i].name);
	return true;
}

bool ob_checkpoint_parse(ob_checkpoint_file *f, const ob_checkpoint_rule *rule, uint32_t areas, const void *bytes,
			 size_t size, const char *name, ob_error *e)
{
	start s = { 0 };
	memcpy(&s, bytes, size < start_bytes(areas) ? size : start_bytes(areas));
	if (!check_start(&s, size, rule, areas, name, e) || !make_room_to_read(f, size, name, e))
		return false;
	memcpy(f->bytes, bytes, size);
	return check_areas(f, &s, rule, name, e);
}

static bool fail_read(const char *path, const ob_error *why, ob_error *e)
{
	return ob_fail(e, "%s: cannot read the checkpoint: %s", path, why->text);
}

static bool read_open(ob_checkpoint_file *f, int fd, size_t size, const ob_checkpoint_rule *rule, uint32_t areas,
		      const char *path, ob_error *e)
{
	start s = { 0 };
	ob_error why;
	const size_t first = size < start_bytes(areas) ? size : start_bytes(areas);
	if (!ob_file_read(fd, &s, first, &why))
		return fail_read(path, &why, e);
	if (!check_start(&s, size, rule, areas, path, e) || !make_room_to_read(f, size, path, e))
		return false;
	memcpy(f->bytes, &s, first);
	if (!ob_file_read(fd, f->bytes + first, size - first, &why))
		return fail_read(path, &why, e);
	return check_areas(f, &s, rule, path, e);
}

bool ob_checkpoint_read(ob_checkpoint_file *f, const ob_checkpoint_rule *rule, uint32_t areas, const char *path,
			ob_error *e)
{
	uint64_t size = 0;
	ob_error why;
	const int fd = ob_file_open(path, OB_CHECKPOINT_BYTES_MAX, &size, &why);
	if (fd < 0)
		return fail_read(path, &why, e);
	const bool good = read_open(f, fd, size, rule, areas, path, e);
	close(fd);
	return good;
}
