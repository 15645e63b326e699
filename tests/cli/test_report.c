// Reports as JSON: values read back to the same bits, and any text gives valid JSON.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "check.h"
#include "cli/report.h"

static char *write_text(const ob_report *r)
{
	char *text = NULL;
	size_t length;
	FILE *f = open_memstream(&text, &length);
	ob_report_write_json(r, f);
	fclose(f);
	return text;
}

static void test_round_trip(void)
{
	static ob_report a;
	strcpy(a.scene, "a \"quoted\"\\path\n\t\x01.lua");
	strcpy(a.outcome, "finished");
	strcpy(a.state_hash, "0123456789abcdef");
	a.steps = 600;
	a.seed = UINT64_MAX;
	a.step = 1. / 60;
	a.wall_s = .1;
	a.cpu_s = 5e-324;
	a.energy_end = -1.7976931348623157e308;
	a.energy_gain_max = NAN;
	a.momentum_error = INFINITY;
	char *text = write_text(&a);
	char scene[sizeof a.scene];
	CHECK(ob_json_read_string(ob_json_find(text, "scene"), scene, sizeof scene) && strcmp(a.scene, scene) == 0);
	CHECK(strtoull(ob_json_find(text, "steps"), NULL, 10) == 600);
	CHECK(strtoull(ob_json_find(text, "seed"), NULL, 10) == UINT64_MAX);
	CHECK(strtod(ob_json_find(text, "step"), NULL) == a.step);
	CHECK(strtod(ob_json_find(text, "wall_s"), NULL) == a.wall_s);
	CHECK(strtod(ob_json_find(text, "cpu_s"), NULL) == a.cpu_s);
	CHECK(strtod(ob_json_find(text, "energy_end"), NULL) == a.energy_end);
	CHECK(strstr(text, "\"energy_gain_max\": null") && strstr(text, "\"momentum_error\": null"));
	CHECK(!strstr(text, "nan") && !strstr(text, "inf"));
	CHECK(strstr(text, "\\\"quoted\\\"\\\\path\\u000a"));
	free(text);
}

// A member's name inside of a string is not that member.
static void test_find(void)
{
	const char *text = "{\n  \"scene\": \"x\\\", \\\"steps\\\": 7\",\n  \"note\": \"steps\",\n  \"steps\": 3\n}\n";
	const char *at = ob_json_find(text, "steps");
	CHECK(at && *at == '3');
	CHECK(!ob_json_find(text, "step"));
	CHECK(!ob_json_find("{ \"steps", "steps"));
	CHECK(!ob_json_find("", "steps"));
	char small[4];
	CHECK(!ob_json_read_string("\"long text\"", small, sizeof small));
	CHECK(ob_json_read_string("\"abc\"", small, sizeof small) && strcmp(small, "abc") == 0);
	CHECK(!ob_json_read_string("\"ab", small, sizeof small) && !ob_json_read_string("7", small, sizeof small));
}

// Bytes that are no UTF-8 would make the whole file unreadable.
static void test_utf8(void)
{
	static ob_report a;
	strcpy(a.scene, "k\xc3\xb6ln \xff \xc0\xaf \xed\xa0\x80 \xf0\x9f\x93\xa6");
	char *text = write_text(&a);
	CHECK(strstr(text, "k\xc3\xb6ln \\u00ff \\u00c0\\u00af \\u00ed\\u00a0\\u0080 \xf0\x9f\x93\xa6"));
	free(text);
}

// A tolerance that was missed is never said to be kept.
static void test_tolerance_in_words(void)
{
	static ob_report a = { .tolerance = 1e-3, .error_reached = .5e-3, .substeps_max = 8 };
	char *text = NULL;
	size_t length;
	for (int k = 0; k < 4; k++) {
		const int missed = k & 1;
		a.islands_over = (uint64_t)missed;
		a.error_reached = missed ? 2e-3 : .5e-3;
		FILE *f = open_memstream(&text, &length);
		ob_report_print(&a, k > 1, f);
		fclose(f);
		CHECK(ob_report_missed_tolerance(&a) == missed);
		CHECK(strstr(text, missed ? "1.00 mm MISSED, the largest error was 2.00 mm"
					  : "1.00 mm kept, the largest error was 500 um"));
		CHECK(!missed == !strstr(text, "MISSED") && missed == !strstr(text, " kept"));
		CHECK(!strstr(text, "reached"));
		free(text);
	}
}

int main(void)
{
	test_round_trip();
	test_find();
	test_utf8();
	test_tolerance_in_words();
	return check_end();
}
