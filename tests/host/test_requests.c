// The table of requests: rows that belong together are neighbours, and docs/control.md has each of them as it is.
//
//   requests CONTROL.MD    prints the lines that it lacks
#include "check.h"

#include <stdlib.h>
#include <string.h>

#include "host/request_table.h"

static char *read_all(const char *path)
{
	enum { ROOM = 1 << 20 };
	char *text = calloc(1, ROOM);
	FILE *f = fopen(path, "re");
	CHECK(f && text && fread(text, 1, ROOM - 1, f) > 0);
	if (f)
		fclose(f);
	return text;
}

// Appends fields as viewers name them: `force` (N), [`point` (m, body frame)].
static void put_fields(char *to, size_t size, const ob_request_field *f)
{
	for (; f->name; f++) {
		const size_t n = strlen(to);
		const bool bound = f->least < f->most;
		char bounds[64] = "";
		if (bound)
			snprintf(bounds, sizeof bounds, "%.10g to %.10g", f->least, f->most);
		snprintf(to + n, size - n, "%s%s`%s`%s%s%s%s%s%s", n ? ", " : "", f->optional ? "[" : "", f->name,
			 bound || *f->unit ? " (" : "", f->unit, bound && *f->unit ? ", " : "", bounds,
			 bound || *f->unit ? ")" : "", f->optional ? "]" : "");
	}
}

static void put_row(char *to, size_t size, const ob_request_row *row)
{
	char usage[128] = "", fields[512] = "";
	if (row->verb)
		ob_request_usage(row, usage, sizeof usage);
	if (row->command) {
		put_fields(fields, sizeof fields, ob_request_target_fields((ob_request_target)row->to));
		put_fields(fields, sizeof fields, row->field);
	}
	snprintf(to, size, "| %s%s%s | %s%s%s%s%s | %s |\n", row->verb ? "`" : "", usage, row->verb ? "`" : "",
		 row->command ? "`" : "", row->command ? row->command : "", row->command ? "`" : "",
		 *fields ? ": " : "", fields, ob_role_name((ob_role)row->role));
}

static void test_documents(const char *path)
{
	char *text = read_all(path), line[1024];
	for (const ob_request_row *row = ob_request_rows; row->kind != OB_REQUEST_ROWS_END; row++) {
		put_row(line, sizeof line, row);
		const bool found = (!row->verb && !row->command) || strstr(text, line);
		if (!found)
			fprintf(stderr, "%s lacks: %s", path, line);
		CHECK(found);
	}
	free(text);
}

static void test_neighbours(void)
{
	for (uint32_t kind = 0; kind < OB_REQUEST_KINDS; kind++)
		CHECK(ob_request_row_of(kind));
	for (const ob_request_row *row = ob_request_rows; row->kind != OB_REQUEST_ROWS_END; row++) {
		const ob_request_row *first = ob_request_row_of(row->kind);
		for (; first < row; first++)
			CHECK(first->kind == row->kind);
		first = ob_request_row_of_control(row->control);
		for (; row->control != OB_CONTROL_HELLO && first < row; first++)
			CHECK(first->control == row->control);
		CHECK(row->role == ob_request_row_of(row->kind)->role && row->to == ob_request_row_of(row->kind)->to);
	}
}

// Fields that a request does not name stay as they are.
static void test_defaults(void)
{
	ob_request r;
	ob_request_begin(&r, ob_request_row_of(OB_REQUEST_STATE));
	CHECK(isnan(r.state.pose.p.x) && isnan(r.state.pose.q.w) && isnan(r.state.v.x) && isnan(r.state.w.x));
	ob_request_begin(&r, ob_request_row_of(OB_REQUEST_DRAG));
	CHECK(r.frequency == 3 && r.point.x == 0);
	ob_request_begin(&r, ob_request_row_of(OB_REQUEST_COLOUR));
	CHECK(r.colour[3] == 1);
}

int main(int argc, char **argv)
{
	CHECK(argc == 2);
	test_neighbours();
	test_defaults();
	test_documents(argv[1]);
	return check_end();
}
