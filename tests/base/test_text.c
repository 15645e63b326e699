// Texts that leave the program and come back: CSV cells and UTF-8.
#include <stdlib.h>
#include <string.h>

#include <ob/error.h>

#include "base/csv.h"
#include "base/number.h"
#include "base/utf8.h"
#include "check.h"

static void test_csv_round_trip(void)
{
	static const char *const texts[] = {
		"plain", "", "a,b", "say \"so\"", "\"", "\"\"", "two\r\nlines", "\n", ","
	};
	static const double numbers[] = { 0, .1, 1. / 3, 5e-324, -1.7976931348623157e308, INFINITY };
	enum { TEXTS = sizeof texts / sizeof *texts, NUMBERS = sizeof numbers / sizeof *numbers };
	char *text = NULL, *cell[TEXTS];
	size_t length;
	FILE *f = open_memstream(&text, &length);
	ob_csv c = { .f = f };
	for (int i = 0; i < TEXTS; i++)
		ob_csv_text(&c, texts[i]);
	ob_csv_end(&c);
	ob_csv_count(&c, UINT64_MAX);
	ob_csv_number(&c, NAN);
	ob_csv_numbers(&c, numbers, NUMBERS);
	ob_csv_end(&c);
	fclose(f);
	ob_csv_reader r = { .at = text };
	CHECK(ob_csv_read(&r, cell, TEXTS) == TEXTS && r.record == 1);
	for (int i = 0; i < TEXTS; i++)
		CHECK(strcmp(cell[i], texts[i]) == 0);
	CHECK(*r.at && ob_csv_read(&r, cell, 3) == 3 && r.record == 2 && !*r.at);
	CHECK(strcmp(cell[0], "18446744073709551615") == 0 && !*cell[1]);
	char *at = cell[2];
	for (int i = 0; i < NUMBERS; i++)
		CHECK(strtod(at, &at) == numbers[i]);
	CHECK(!*at && strncmp(cell[2], "0 0.1 0.333", 11) == 0); // only as many digits as needed
	free(text);
}

static void test_csv_foreign(void)
{
	char text[] = "a,\"b\"\r\nc\rd,,\"\"", *cell[2];
	ob_csv_reader r = { .at = text };
	CHECK(ob_csv_read(&r, cell, 2) == 2 && strcmp(cell[1], "b") == 0);
	CHECK(ob_csv_read(&r, cell, 2) == 1 && strcmp(cell[0], "c") == 0);
	CHECK(ob_csv_read(&r, cell, 2) == 3 && strcmp(cell[0], "d") == 0 && !*cell[1] && !*r.at);
	static const char *const broken[] = { "\"a", "\"", "\"a\"b", "a,\"\"\"", "\"a\"\"" };
	for (size_t i = 0; i < sizeof broken / sizeof *broken; i++) {
		char copy[16];
		strcpy(copy, broken[i]);
		ob_csv_reader bad = { .at = copy };
		CHECK(ob_csv_read(&bad, cell, 2) == 0);
	}
}

static void test_numbers(void)
{
	CHECK(strcmp(ob_number_text(.132).text, "0.132") == 0 && strcmp(ob_number_text(1e6).text, "1000000") == 0);
	CHECK(strcmp(ob_number_text(nextafter(.132, 1)).text, ob_number_text(.132).text) != 0);
	CHECK(strcmp(ob_number_text(-NAN).text, "nan") == 0 && strcmp(ob_number_text(-INFINITY).text, "-inf") == 0);
}

static void test_utf8(void)
{
	static const struct {
		const char *text;
		size_t bytes;
		uint32_t code;
	} characters[] = {
		{ "a", 1, 'a' },
		{ "", 1, 0 },
		{ "\xc3\xb6", 2, 0xf6 },
		{ "\xe2\x88\x92", 3, 0x2212 },
		{ "\xf0\x9f\x93\xa6", 4, 0x1f4e6 },
		{ "\xf4\x8f\xbf\xbf", 4, 0x10ffff },
		{ "\xff", 0, OB_UTF8_REPLACEMENT },
		{ "\x80", 0, OB_UTF8_REPLACEMENT },
		{ "\xc3", 0, OB_UTF8_REPLACEMENT }, // truncated
		{ "\xe2\x88", 0, OB_UTF8_REPLACEMENT },
		{ "\xc0\xaf", 0, OB_UTF8_REPLACEMENT }, // overlong
		{ "\xe0\x80\xaf", 0, OB_UTF8_REPLACEMENT },
		{ "\xed\xa0\x80", 0, OB_UTF8_REPLACEMENT }, // a surrogate
		{ "\xf4\x90\x80\x80", 0, OB_UTF8_REPLACEMENT }, // beyond U+10FFFF
	};
	for (size_t i = 0; i < sizeof characters / sizeof *characters; i++) {
		size_t bytes;
		CHECK(ob_utf8_length(characters[i].text) == characters[i].bytes);
		CHECK(ob_utf8_decode(characters[i].text, &bytes) == characters[i].code);
		CHECK(bytes == (characters[i].bytes ? characters[i].bytes : 1));
	}
	CHECK(ob_utf8_count("") == 0 && ob_utf8_count("k\xc3\xb6ln \xff\xe2\x88!") == 9);
}

static void check_plain(const char *text, const char *plain)
{
	char copy[64];
	strcpy(copy, text);
	ob_utf8_make_plain(copy);
	CHECK(strcmp(copy, plain) == 0);
	ob_utf8_make_plain(copy);
	CHECK(strcmp(copy, plain) == 0);
}

// Text for a terminal stays text there.
static void test_plain(void)
{
	check_plain("", "");
	check_plain("a box, k\xc3\xb6ln \xe2\x88\x92 \xf0\x9f\x93\xa6",
		    "a box, k\xc3\xb6ln \xe2\x88\x92 \xf0\x9f\x93\xa6");
	check_plain("a\033[2J\nb\tc\x7f", "a [2J b c ");
	check_plain("a\xc2\x9b"
		    "31mb", // CSI of Latin-1
		    "a?31mb");
	check_plain("\x9b"
		    "31m\xff\xe2\x88", // as a byte; truncated
		    "?31m???");
	check_plain("exe.\xe2\x80\xaegnp", "exe.?gnp"); // right-to-left override
	check_plain("a\xe2\x81\xa6\xe2\x80\xa8\xe2\x80\x8f\xd8\x9c", "a????");
	ob_error e;
	ob_fail(&e, "%s: %s", "x\033]0;t\a", "\xc2\x85");
	CHECK(strcmp(e.text, "x ]0;t : ?") == 0);
}

int main(void)
{
	test_csv_round_trip();
	test_csv_foreign();
	test_numbers();
	test_utf8();
	test_plain();
	return check_end();
}
