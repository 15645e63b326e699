#include "lab/case.h"

#include <fnmatch.h>
#include <stdlib.h>
#include <string.h>

#include "experiment/table.h"
#include "lab/scene.h"
#include "lab_scenes.h" // generated: lab_NAME_lua[], of each file of scenes/lab

static const ob_case *cases[OB_LIST_CASES + 1]; // the end is NULL
const ob_case *const *ob_cases = cases;
static uint32_t digest;

const ob_case *ob_case_find(const char *name)
{
	for (const ob_case *const *c = ob_cases; *c; c++)
		if (!strcmp((*c)->name, name))
			return *c;
	return NULL;
}

// Inserts a case behind those of its row and of rows before; one without a row is the last.
static bool add(const ob_case *c, ob_error *e)
{
	size_t n = 0;
	while (cases[n])
		n++;
	if (ob_case_find(c->name))
		return ob_fail(e, "%s: there is a case \"%s\" already: rename it, by case { name = ... } or its file",
			       c->text->path, c->name);
	if (n == OB_LIST_CASES)
		return ob_fail(e, "%s: expected at most %d cases together", c->text->path, OB_LIST_CASES);
	for (; n > 0 && c->row > 0 && (cases[n - 1]->row > c->row || cases[n - 1]->row == 0); n--)
		cases[n] = cases[n - 1];
	cases[n] = c;
	return true;
}

static bool add_own(const ob_case *c, ob_error *e)
{
	for (const char *t = c->text->text; *t; t++) // FNV-1a
		digest = (digest ^ (unsigned char)*t) * 16777619u;
	return add(c, e);
}

bool ob_cases_open(const char *const *file, size_t files, ob_error *e)
{
	static const struct {
		const char *path, *text;
	} own[] = {
#define OB_LAB_SCENE(name) { "scenes/lab/" #name ".lua", lab_##name##_lua },
		OB_LAB_SCENES
#undef OB_LAB_SCENE
	};
	bool fine = true;
	for (size_t i = 0; fine && i < sizeof own / sizeof *own; i++)
		fine = ob_lab_scene_read(own[i].path, own[i].text, add, e);
	digest = files ? 2166136261u : 0;
	for (size_t i = 0; fine && i < files; i++)
		fine = ob_lab_scene_read(file[i], NULL, add_own, e);
	return fine;
}

uint32_t ob_cases_digest(void)
{
	return digest;
}

// ---- list

// Adds the chosen cases, and preserves the order.
static bool add_chosen(ob_case_list *l, bool (*chosen)(const ob_case *c, const char *word), const char *word)
{
	ob_case_list all = { 0 };
	bool any = false;
	size_t old = 0;
	for (const ob_case *const *c = ob_cases; *c && all.count < OB_LIST_CASES; c++) {
		bool had = old < l->count && l->of[old] == *c, is = chosen(*c, word);
		old += had;
		any |= is;
		if (had || is)
			all.of[all.count++] = *c;
	}
	*l = all;
	return any;
}

static bool is_named(const ob_case *c, const char *word)
{
	return strcmp(c->name, word) == 0;
}

static bool is_row(const ob_case *c, const char *word)
{
	return strspn(word, "0123456789") == strlen(word) && atoi(word) == c->row;
}

static bool is_of_file(const ob_case *c, const char *word)
{
	return c->text && strcmp(c->text->path, word) == 0;
}

static bool matches(const ob_case *c, const char *word)
{
	return *word && (fnmatch(word, c->name, 0) == 0 || strncmp(word, c->name, strlen(word)) == 0);
}

bool ob_list_add_cases(ob_case_list *l, const char *word)
{
	return add_chosen(l, is_of_file, word) || add_chosen(l, is_named, word) || add_chosen(l, is_row, word) ||
	       add_chosen(l, matches, word);
}

static bool is_wanted(const ob_case *c, const char *quick)
{
	return !c->slow || !quick;
}

void ob_list_add_all(ob_case_list *l, bool quick_only)
{
	add_chosen(l, is_wanted, quick_only ? "quick" : NULL);
}

static bool is_in(const char *names, const char *name)
{
	size_t n = strlen(name);
	for (const char *at = names; (at = strstr(at, name)); at += n)
		if ((at == names || at[-1] == ',') && (!at[n] || at[n] == ','))
			return true;
	return false;
}

bool ob_list_engines(ob_engine_list *l, const char *names, char word[64])
{
	const bool all = strcmp(names, "all") == 0, free = is_in(names, "free");
	*l = (ob_engine_list){ 0 };
	for (const ob_engine_kind *const *k = ob_engine_kinds; *k && l->count < OB_LIST_ENGINES; k++)
		if ((*k)->free ? free || is_in(names, (*k)->name) : all || is_in(names, (*k)->name))
			l->of[l->count++] = *k;
	for (const char *at = names; !all && at; at = strchr(at, ','), at = at ? at + 1 : NULL) {
		snprintf(word, 64, "%.*s", (int)strcspn(at, ","), at);
		if (strcmp(word, "free") != 0 && !ob_engine_find(word))
			return false;
	}
	return true;
}

static void print_target(FILE *f, const ob_figure_def *def)
{
	fprintf(f, "%s \u2264 %s\n", def->name, ob_word_quantity(def->target, def->unit).text);
}

void ob_list_print(FILE *f, const ob_case_list *l)
{
	int name = 4, title = 5;
	for (size_t i = 0; i < l->count; i++) {
		int n = (int)strlen(l->of[i]->name), t = (int)strlen(l->of[i]->title);
		name = n > name ? n : name;
		title = t > title ? t : title;
	}
	fprintf(f, "Row  %-*s    %-*s  Target at 60 Hz\n", name, "Name", title, "Title");
	for (size_t i = 0; i < l->count; i++) {
		const ob_case *c = l->of[i];
		fprintf(f, c->row > 0 ? "%3d" : "   ", c->row);
		fprintf(f, "  %-*s %c  %-*s", name, c->name, c->slow ? ' ' : '*', title, c->title);
		int indent = 2; // indentation of a case's first target; each other has a line of its own
		for (uint32_t j = 0; j < c->figures; j++) {
			if (isnan(c->figure[j].target))
				continue;
			fprintf(f, "%*s", indent, "");
			print_target(f, &c->figure[j]);
			indent = name + title + 11;
		}
		if (indent == 2)
			fputs("  none promised\n", f);
	}
	fputs("* quick subset (--quick)\n", f);
}
