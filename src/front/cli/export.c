// obsim export: a page of a record, or MCAP.
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "cli/command.h"
#include "cli/output.h"
#include "cli/quantity.h"
#include "record/mcap.h"
#include "serve/film.h"

static bool check_operands(const ob_arguments *a, ob_error *e)
{
	struct stat from, to;
	if (!a->operand || !a->operands[1])
		return ob_fail(e, "export needs a record and a file: obsim export FILE.h5 PAGE.html, or FILE.mcap");
	if (stat(a->operands[0], &from) == 0 && stat(a->operands[1], &to) == 0 && from.st_dev == to.st_dev &&
	    from.st_ino == to.st_ino)
		return ob_fail(e, "%s: this would replace the record", a->operands[1]);
	return ob_output_fits("export", a->operands[1], OB_OUTPUT_PAGE | OB_OUTPUT_MCAP, e);
}

// Makes the whole page in memory; NULL and e.
static ob_message *make_page(const ob_arguments *a, ob_error *e)
{
	const char *path = a->operand;
	double seconds = OB_FILM_SECONDS;
	ob_recording *r = ob_number_real("patience", a->value[OB_OPTION_PATIENCE], 0, 1e9, &seconds, e)
				  ? ob_recording_open(path, e)
				  : NULL;
	ob_message *film = r ? ob_film_make(r, path, seconds, e) : NULL;
	ob_message *page = film ? ob_film_page_whole(film) : NULL;
	if (film && !page)
		ob_fail(e, "%s: no memory to make a page of it", path);
	ob_message_release(film);
	ob_recording_close(r);
	return page;
}

static bool write_page(const ob_message *page, const char *path, ob_error *e)
{
	FILE *f = fopen(path, "we");
	if (!f)
		return ob_fail(e, "%s: %s", path, strerror(errno));
	errno = 0;
	bool whole = fwrite(page->bytes, 1, page->size, f) == page->size;
	whole &= fclose(f) == 0;
	return whole || ob_fail(e, "%s: %s", path, errno ? strerror(errno) : "not all of it was taken");
}

static bool is_mcap(const char *path)
{
	const size_t n = strlen(path);
	return n > 5 && strcasecmp(path + n - 5, ".mcap") == 0;
}

static int export_mcap(const ob_arguments *a, ob_error *e)
{
	double seconds = OB_FILM_SECONDS;
	ob_recording *r = ob_number_real("patience", a->value[OB_OPTION_PATIENCE], 0, 1e9, &seconds, e)
				  ? ob_recording_open(a->operand, e)
				  : NULL;
	if (!r)
		return ob_command_fail(OB_EXIT_USAGE, e->text);
	const bool written = ob_mcap_write(r, a->operand, a->operands[1], seconds, e);
	ob_recording_close(r);
	if (written)
		printf("%s: MCAP, for Foxglove and others\n", a->operands[1]);
	return written ? OB_EXIT_OK : ob_command_fail(OB_EXIT_FAILED, e->text);
}

int ob_command_export(const ob_arguments *a)
{
	ob_error e;
	if (a->operand && a->operands[1] && is_mcap(a->operands[1]) && check_operands(a, &e))
		return export_mcap(a, &e);
	ob_message *page = check_operands(a, &e) ? make_page(a, &e) : NULL;
	if (!page)
		return ob_command_fail(OB_EXIT_USAGE, e.text);
	bool written = write_page(page, a->operands[1], &e);
	if (written)
		printf("%s: %.1f MB, to be opened in any browser\n", a->operands[1], 1e-6 * (double)page->size);
	ob_message_release(page);
	return written ? OB_EXIT_OK : ob_command_fail(OB_EXIT_FAILED, e.text);
}
