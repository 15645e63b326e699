// The contents, and ranges of their bytes that requests name.
#include "check.h"

#include <string.h>

#include "serve/content.h"

static void check_range(const char *header, ob_range_kind kind, size_t first, size_t end)
{
	size_t a, b;
	ob_range_kind got = ob_content_range(header, 1000, &a, &b);
	CHECK(got == kind);
	if (got != OB_RANGE_NONE)
		CHECK(a == first && b == end);
}

int main(void)
{
	const ob_content *page = ob_content_find("/index.html"), *script = ob_content_find("/main.js");
	CHECK(page && script && !ob_content_find("/") && !ob_content_find("/../etc/passwd") && !ob_content_find(""));
	CHECK(page && strstr(page->type, "html") && page->size > 100 && page->tag[0] == '"');
	CHECK(script && memmem(script->bytes, script->size, "module_drawing = ", 17));
	CHECK(script && memmem(script->bytes, script->size, "uniform Frame", 13)); // shaders, with their includes
	CHECK(page && script && strcmp(page->tag, script->tag) != 0);

	check_range("bytes=0-99", OB_RANGE_PART, 0, 100);
	check_range("bytes=10-", OB_RANGE_PART, 10, 1000);
	check_range("bytes=999-5000", OB_RANGE_PART, 999, 1000);
	check_range("bytes=-300", OB_RANGE_PART, 700, 1000);
	check_range("bytes=-5000", OB_RANGE_PART, 0, 1000);
	check_range("bytes=1000-", OB_RANGE_NONE, 0, 0);
	check_range("bytes=-0", OB_RANGE_NONE, 0, 0);
	const char *const all[] = { "",
				    "bytes",
				    "bytes=",
				    "bytes=-",
				    "bytes=5-4",
				    "bytes=1-2,5-6",
				    "lines=1-2",
				    "bytes=a-b",
				    "bytes=1-2x",
				    "bytes=--1",
				    "bytes=99999999999999999999-" };
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		check_range(all[i], OB_RANGE_ALL, 0, 1000);

	CHECK(ob_content_has_tag("\"ab\"", "\"ab\"") && ob_content_has_tag("\"x\", W/\"ab\"", "\"ab\""));
	CHECK(ob_content_has_tag("*", "\"ab\"") && !ob_content_has_tag("\"abc\"", "\"ab\"") &&
	      !ob_content_has_tag("", "\"ab\""));
	return check_end();
}
