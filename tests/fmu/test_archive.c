// FMUs as files: good ones, and one line for each that is damaged, hostile, or another file.
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <zip.h>

#include "base/random.h"
#include "check.h"
#include "fmu/archive.h"

#define HEAD2 "<fmiModelDescription fmiVersion='2.0' modelName='m' guid='{k}'>"
#define KIND2 "<CoSimulation modelIdentifier='m' canGetAndSetFMUstate='true' canSerializeFMUstate='true'/>"
#define BODY2 \
	"<ModelVariables><ScalarVariable name='in' valueReference='7' causality='input'><Real " \
	"start='0'/></ScalarVariable>" \
	"<ScalarVariable name='n' valueReference='8'><Integer/></ScalarVariable>" \
	"<ScalarVariable name='out' valueReference='9' causality='output'><Real/></ScalarVariable></ModelVariables>"
#define GOOD2 HEAD2 KIND2 BODY2 "</fmiModelDescription>"
#define HEAD3 "<fmiModelDescription fmiVersion='3.0' modelName='m' instantiationToken='{k}'>"
#define KIND3 "<CoSimulation modelIdentifier='m' canGetAndSetFMUState='true' canSerializeFMUState='true'/>"
#define GOOD3 \
	HEAD3 KIND3 "<ModelVariables><Float64 name='in' valueReference='7' causality='input'/>" \
		    "<Float64 name='array' valueReference='8'><Dimension start='2'/><Dimension start='3'/></Float64>" \
		    "<Float64 name='k' valueReference='9' causality='parameter' " \
		    "start='1'/></ModelVariables></fmiModelDescription>"

#if defined(__x86_64__)
#define FOLDER2 "linux64"
#define FOLDER3 "x86_64-linux"
#else
#define FOLDER2 "aarch64-linux"
#define FOLDER3 "aarch64-linux"
#endif

typedef struct entry {
	const char *name, *text;
	size_t size; // 0: of the text
} entry;

// Packs entries, up to one without a name, into a zip archive in memory; the caller frees it.
static unsigned char *pack(const entry *e, size_t *size)
{
	zip_error_t error;
	zip_error_init(&error);
	zip_source_t *archive = zip_source_buffer_create(NULL, 0, 0, &error);
	zip_source_keep(archive);
	zip_t *zip = zip_open_from_source(archive, ZIP_TRUNCATE, &error);
	for (; e->name; e++)
		zip_file_add(zip, e->name, zip_source_buffer(zip, e->text, e->size ? e->size : strlen(e->text), 0), 0);
	zip_close(zip);
	zip_stat_t about;
	zip_source_stat(archive, &about);
	unsigned char *bytes = malloc(about.size);
	zip_source_open(archive);
	*size = (size_t)zip_source_read(archive, bytes, about.size);
	zip_source_close(archive);
	zip_source_free(archive);
	return bytes;
}

static bool read_entries(const entry *e, ob_fmu_file *f, ob_error *error)
{
	size_t size;
	unsigned char *bytes = pack(e, &size);
	const bool good = ob_fmu_read(bytes, size, f, error);
	free(bytes);
	return good;
}

static void refuse(const entry *e, const char *saying)
{
	ob_fmu_file f;
	ob_error error = { "" };
	CHECK(!read_entries(e, &f, &error));
	CHECK(strstr(error.text, saying));
	if (!strstr(error.text, saying))
		fprintf(stderr, "  expected \"%s\", got \"%s\"\n", saying, error.text);
	CHECK(f.variables == 0 && !f.library);
}

static void refuse_text(const char *text, const char *saying)
{
	refuse((entry[]){ { "modelDescription.xml", text, 0 },
			  { "binaries/" FOLDER2 "/m.so", "x", 0 },
			  { NULL, NULL, 0 } },
	       saying);
}

static void test_good(void)
{
	ob_fmu_file f;
	ob_error e;
	CHECK(read_entries((entry[]){ { "modelDescription.xml", GOOD2, 0 },
				      { "binaries/" FOLDER2 "/m.so", "code", 0 },
				      { NULL, NULL, 0 } },
			   &f, &e));
	CHECK(f.standard == 2 && f.variables == 2 && strcmp(f.token, "{k}") == 0 && strcmp(f.identifier, "m") == 0);
	CHECK(strcmp(f.variable[0].name, "in") == 0 && f.variable[0].reference == 7);
	CHECK(f.variable[0].causality == OB_FMU_INPUT && f.variable[1].causality == OB_FMU_OUTPUT);
	CHECK(f.library_bytes == 4 && memcmp(f.library, "code", 4) == 0);
	ob_fmu_finish(&f);
	CHECK(read_entries((entry[]){ { "modelDescription.xml", GOOD3, 0 },
				      { "binaries/" FOLDER3 "/m.so", "code", 0 },
				      { NULL, NULL, 0 } },
			   &f, &e));
	CHECK(f.standard == 3 && f.variables == 2); // arrays are left out
	CHECK(strcmp(f.variable[1].name, "k") == 0 && f.variable[1].causality == OB_FMU_PARAMETER);
	ob_fmu_finish(&f);
}

static void test_descriptions(void)
{
	refuse_text("", "at most 4 MiB");
	refuse_text("<fmiModelDescription", "modelDescription.xml:1: ");
	refuse_text("<html/>", "expected fmiModelDescription");
	refuse_text("<fmiModelDescription fmiVersion='1.0'/>", "expected fmiVersion 2.0 or 3.0");
	refuse_text("<fmiModelDescription fmiVersion='2.0'/>", "expected guid");
	refuse_text(HEAD2 "</fmiModelDescription>", "no co-simulation");
	refuse_text(HEAD2 "<CoSimulation/></fmiModelDescription>", "expected modelIdentifier");
	refuse_text(HEAD2 "<CoSimulation modelIdentifier='../m'/></fmiModelDescription>", "letters, digits");
	refuse_text(HEAD2 "<CoSimulation modelIdentifier='m'/></fmiModelDescription>", "cannot hand out its state");
	refuse_text(HEAD2 KIND2 "<ScalarVariable name='a' valueReference='-x'/></fmiModelDescription>",
		    "valueReference");
	refuse_text(HEAD2 KIND2 "<ScalarVariable name='a' valueReference='1'><Real></fmiModelDescription>",
		    "mismatched tag");
	refuse_text("<!DOCTYPE x [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;&a;'>]>" GOOD2, "no DOCTYPE");
	refuse_text("<!DOCTYPE x SYSTEM 'file:///etc/passwd'>" GOOD2, "no DOCTYPE");
}

static void test_archives(void)
{
	ob_fmu_file f;
	ob_error e;
	CHECK(!ob_fmu_read((const unsigned char *)"no zip", 6, &f, &e) && strstr(e.text, "no zip archive"));
	refuse((entry[]){ { "other", "x", 0 }, { NULL, NULL, 0 } }, "no modelDescription.xml");
	refuse((entry[]){ { "modelDescription.xml", GOOD2, 0 }, { "binaries/win64/m.dll", "x", 0 }, { NULL, NULL, 0 } },
	       "it has no binaries/" FOLDER2 "/m.so");
	refuse((entry[]){ { "modelDescription.xml", GOOD2, 0 }, { "resources/map.csv", "x", 0 }, { NULL, NULL, 0 } },
	       "it has resources");
	const size_t much = 64 << 20;
	char *zeroes = calloc(1, much); // packed by a thousand
	refuse((entry[]){ { "modelDescription.xml", zeroes, much }, { NULL, NULL, 0 } }, "at most 4 MiB");
	refuse((entry[]){ { "modelDescription.xml", GOOD2, 0 },
			  { "binaries/" FOLDER2 "/m.so", zeroes, much },
			  { NULL, NULL, 0 } },
	       "at most 8 MiB");
	free(zeroes);
}

// Elements in elements, and more variables than allowed.
static void test_large(void)
{
	const size_t most = 3 << 20;
	char *text = malloc(most + 200);
	size_t n = (size_t)sprintf(text, HEAD2);
	while (n < most)
		n += (size_t)sprintf(text + n, "<a>");
	refuse_text(text, "modelDescription.xml:1: ");
	n = (size_t)sprintf(text, HEAD3);
	while (n < most)
		n += (size_t)sprintf(text + n, "<Float64 name='a' valueReference='1'/>");
	refuse_text(text, "modelDescription.xml:1: ");
	free(text);
}

// Any bytes are read or refused with a line, and nothing leaks.
static void test_mutations(void)
{
	size_t size;
	unsigned char *good = pack((entry[]){ { "modelDescription.xml", GOOD3, 0 },
					      { "binaries/" FOLDER3 "/m.so", "code", 0 },
					      { NULL, NULL, 0 } },
				   &size);
	unsigned char *bytes = malloc(size);
	uint64_t rng = 1;
	for (int i = 0; i < 3000; i++) {
		memcpy(bytes, good, size);
		for (uint64_t n = 1 + ob_splitmix(&rng) % 4; n > 0; n--)
			bytes[ob_splitmix(&rng) % size] = (unsigned char)ob_splitmix(&rng);
		const size_t length = ob_splitmix(&rng) % 4 ? size : ob_splitmix(&rng) % size;
		ob_fmu_file f;
		ob_error e = { "" };
		if (ob_fmu_read(bytes, length, &f, &e))
			ob_fmu_finish(&f);
		else
			CHECK(*e.text);
	}
	free(bytes);
	free(good);
}

int main(void)
{
	test_good();
	test_descriptions();
	test_archives();
	test_large();
	test_mutations();
	return check_end();
}
