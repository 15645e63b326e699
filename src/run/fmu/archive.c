// Reads FMUs: zip archives by libzip, descriptions by expat. Files of strangers: nothing is written to disk, sizes are
// bounded before memory is taken, names in the archive are looked up and never followed.
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <expat.h>
#include <zip.h>

#include "fmu/part.h"

enum { VARIABLES_MAX = 100000, ENTRIES_MAX = 10000 };

#if defined(__x86_64__)
static const char *const folder[] = { [2] = "linux64", [3] = "x86_64-linux" };
#elif defined(__aarch64__)
static const char *const folder[] = { [2] = "aarch64-linux", [3] = "aarch64-linux" };
#else
static const char *const folder[] = { [2] = "linux32", [3] = "x86-linux" };
#endif

// ---- the description

typedef struct description {
	ob_fmu_file *out;
	ob_error *e;
	XML_Parser parser;
	bool failed, co_simulation, keeps_state, needs_tool;
	ob_fmu_variable pending; // FMI 2: a ScalarVariable, whose type is an element of its own
	bool open, scalar; // open: pending is set; scalar: the last variable has had no dimension yet
} description;

__attribute__((format(printf, 2, 3))) static void fail(description *d, const char *format, ...)
{
	if (d->failed)
		return;
	d->failed = true;
	va_list list;
	char text[200];
	va_start(list, format);
	vsnprintf(text, sizeof text, format, list);
	va_end(list);
	ob_fail(d->e, "modelDescription.xml:%lu: %s", (unsigned long)XML_GetCurrentLineNumber(d->parser), text);
	XML_StopParser(d->parser, XML_FALSE);
}

static const char *attribute(const char **list, const char *name)
{
	for (; *list; list += 2)
		if (strcmp(list[0], name) == 0)
			return list[1];
	return NULL;
}

static bool is_true(const char **list, const char *name)
{
	const char *value = attribute(list, name);
	return value && (strcmp(value, "true") == 0 || strcmp(value, "1") == 0);
}

static void take_text(description *d, const char *element, const char **list, const char *name, char *out, size_t room)
{
	const char *value = attribute(list, name);
	if (!value || !*value || strlen(value) >= room)
		fail(d, "%s: expected %s of 1 to %zu bytes", element, name, room - 1);
	else
		snprintf(out, room, "%s", value);
}

static void take_head(description *d, const char **list)
{
	const char *version = attribute(list, "fmiVersion");
	if (version && (strcmp(version, "2.0") == 0 || strncmp(version, "3.0", 3) == 0))
		d->out->standard = (uint32_t)(*version - '0');
	else
		fail(d, "expected fmiVersion 2.0 or 3.0, got \"%.20s\"", version ? version : "");
	take_text(d, "fmiModelDescription", list, d->out->standard == 2 ? "guid" : "instantiationToken", d->out->token,
		  sizeof d->out->token);
}

static void take_kind(description *d, const char **list)
{
	static const char allowed[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_";
	char *name = d->out->identifier;
	d->co_simulation = true;
	take_text(d, "CoSimulation", list, "modelIdentifier", name, sizeof d->out->identifier);
	if (!d->failed && name[strspn(name, allowed)])
		fail(d, "expected letters, digits and _ in modelIdentifier");
	d->keeps_state = d->out->standard == 2
				 ? is_true(list, "canGetAndSetFMUstate") && is_true(list, "canSerializeFMUstate")
				 : is_true(list, "canGetAndSetFMUState") && is_true(list, "canSerializeFMUState");
	d->needs_tool = is_true(list, "needsExecutionTool");
}

static ob_fmu_causality causality_of(const char **list)
{
	const char *is = attribute(list, "causality");
	return !is                            ? OB_FMU_OTHER
	       : strcmp(is, "input") == 0     ? OB_FMU_INPUT
	       : strcmp(is, "output") == 0    ? OB_FMU_OUTPUT
	       : strcmp(is, "parameter") == 0 ? OB_FMU_PARAMETER
					      : OB_FMU_OTHER;
}

static bool read_variable(description *d, const char **list, ob_fmu_variable *out)
{
	const char *name = attribute(list, "name"), *reference = attribute(list, "valueReference");
	char *end = NULL;
	const unsigned long long number = reference ? strtoull(reference, &end, 10) : 0;
	if (!name || !*name || strlen(name) > 1000 || !end || end == reference || *end || number > UINT32_MAX) {
		fail(d, "expected a variable with a name and a valueReference");
		return false;
	}
	*out = (ob_fmu_variable){ strdup(name), (uint32_t)number, causality_of(list) };
	if (!out->name)
		fail(d, "out of memory");
	return out->name;
}

// Takes ownership of the name.
static void add(description *d, ob_fmu_variable v)
{
	ob_fmu_file *f = d->out;
	ob_fmu_variable *more = f->variable;
	if (f->variables == VARIABLES_MAX)
		fail(d, "expected at most %d variables", VARIABLES_MAX);
	else if ((f->variables & (f->variables - 1)) == 0) // grows at powers of 2
		more = realloc(f->variable, (f->variables ? 2 * (size_t)f->variables : 1) * sizeof *more);
	if (!more)
		fail(d, "out of memory");
	if (d->failed) {
		free(v.name);
		return;
	}
	f->variable = more;
	f->variable[f->variables++] = v;
	d->scalar = true;
}

static void begin(void *user, const char *element, const char **list)
{
	description *d = user;
	ob_fmu_variable v;
	if (!d->out->standard) {
		if (strcmp(element, "fmiModelDescription") == 0)
			take_head(d, list);
		else
			fail(d, "expected fmiModelDescription, got %.40s", element);
	} else if (strcmp(element, "CoSimulation") == 0) {
		take_kind(d, list);
	} else if (d->out->standard == 3 && strcmp(element, "Float64") == 0) {
		if (read_variable(d, list, &v))
			add(d, v);
	} else if (d->out->standard == 3 && strcmp(element, "Dimension") == 0 && d->scalar) {
		free(d->out->variable[--d->out->variables].name); // arrays cannot be connected
		d->scalar = false;
	} else if (d->out->standard == 2 && strcmp(element, "ScalarVariable") == 0 && !d->open) {
		d->open = read_variable(d, list, &d->pending);
	} else if (d->open && strcmp(element, "Real") == 0) {
		d->open = false;
		add(d, d->pending);
	}
}

static void end(void *user, const char *element)
{
	description *d = user;
	if (strcmp(element, "Float64") == 0)
		d->scalar = false;
	if (!d->open || strcmp(element, "ScalarVariable") != 0)
		return;
	free(d->pending.name); // of another type
	d->open = false;
}

// Entities can grow without bound, or name files: none can be declared.
static void refuse_doctype(void *user, const char *name, const char *system, const char *public, int has_internal)
{
	fail(user, "expected no DOCTYPE");
}

static bool describe(const char *text, size_t size, ob_fmu_file *out, ob_error *e)
{
	description d = { .out = out, .e = e, .parser = XML_ParserCreate(NULL) };
	if (!d.parser)
		return ob_fail(e, "out of memory");
	XML_SetUserData(d.parser, &d);
	XML_SetElementHandler(d.parser, begin, end);
	XML_SetStartDoctypeDeclHandler(d.parser, refuse_doctype);
	if (XML_Parse(d.parser, text, (int)size, 1) != XML_STATUS_OK)
		fail(&d, "%s", XML_ErrorString(XML_GetErrorCode(d.parser)));
	if (d.open)
		free(d.pending.name);
	XML_ParserFree(d.parser);
	if (d.failed)
		return false;
	if (!d.co_simulation)
		return ob_fail(e, "it has no co-simulation: export it as one (CoSimulation)");
	if (d.needs_tool)
		return ob_fail(e, "it needs the program that made it (needsExecutionTool)");
	return d.keeps_state || ob_fail(e, "it cannot hand out its state, which a kill would lose: export it with "
					   "canGetAndSetFMUstate and canSerializeFMUstate");
}

// ---- the archive

// Reads one file of the archive into new memory. NULL and e: there is none, it is damaged, or larger than most.
static void *read_entry(zip_t *zip, const char *name, size_t most, size_t *size, ob_error *e)
{
	zip_stat_t about;
	if (zip_stat(zip, name, 0, &about) != 0 || !(about.valid & ZIP_STAT_SIZE)) {
		ob_fail(e, "it has no %s", name);
		return NULL;
	}
	if (about.size == 0 || about.size > most) {
		ob_fail(e, "expected %s of at most %zu MiB, got %llu bytes", name, most >> 20,
			(unsigned long long)about.size);
		return NULL;
	}
	zip_file_t *file = zip_fopen(zip, name, 0);
	char *bytes = file ? malloc(about.size) : NULL;
	zip_int64_t n = bytes ? zip_fread(file, bytes, about.size) : -1;
	const bool whole = n == (zip_int64_t)about.size && zip_fread(file, &(char){ 0 }, 1) == 0;
	if (file)
		zip_fclose(file);
	if (whole) {
		*size = about.size;
		return bytes;
	}
	free(bytes);
	ob_fail(e, "its %s is damaged", name);
	return NULL;
}

static bool has_resources(zip_t *zip)
{
	for (zip_int64_t i = 0; i < zip_get_num_entries(zip, 0); i++) {
		const char *name = zip_get_name(zip, (zip_uint64_t)i, 0);
		if (name && strncmp(name, "resources/", 10) == 0 && name[10])
			return true;
	}
	return false;
}

static bool read_all(zip_t *zip, ob_fmu_file *out, ob_error *e)
{
	size_t size = 0;
	if (zip_get_num_entries(zip, 0) > ENTRIES_MAX)
		return ob_fail(e, "expected at most %d files in it", ENTRIES_MAX);
	char *text = read_entry(zip, "modelDescription.xml", OB_FMU_DESCRIPTION_BYTES, &size, e);
	const bool good = text && describe(text, size, out, e);
	free(text);
	if (!good)
		return false;
	if (has_resources(zip))
		return ob_fail(e, "it has resources, which are not unpacked: export it without");
	char name[OB_FMU_NAME_MAX + 40];
	snprintf(name, sizeof name, "binaries/%s/%s.so", folder[out->standard], out->identifier);
	out->library = read_entry(zip, name, OB_FMU_LIBRARY_BYTES, &size, e);
	out->library_bytes = (uint32_t)size;
	return out->library;
}

static bool read_archive(const unsigned char *bytes, size_t size, ob_fmu_file *out, ob_error *e)
{
	zip_error_t error;
	zip_error_init(&error);
	zip_source_t *source = zip_source_buffer_create(bytes, size, 0, &error);
	zip_t *zip = source ? zip_open_from_source(source, ZIP_RDONLY, &error) : NULL;
	if (!zip) {
		ob_fail(e, "it is no zip archive: %s", zip_error_strerror(&error));
		zip_source_free(source);
	}
	const bool good = zip && read_all(zip, out, e);
	if (zip)
		zip_discard(zip);
	zip_error_fini(&error);
	return good;
}

OB_PART(ob_fmu_part) = { OB_PART_HEAD(ob_fmu_part), .read = read_archive };
