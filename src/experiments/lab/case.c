#include "lab/case.h"

#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "lab/list.h"
#include "lab/scene.h"
#include "lab_scenes.h" // generated: lab_NAME_lua[], of each file of scenes/lab

static const ob_case *all[OB_LIST_CASES + 1]; // the end is NULL
const ob_case *const *ob_cases = all;
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
	while (all[n])
		n++;
	if (ob_case_find(c->name))
		return ob_fail(e, "%s: there is a case \"%s\" already: rename it, by case { name = ... } or its file",
			       c->text->path, c->name);
	if (n == OB_LIST_CASES)
		return ob_fail(e, "%s: expected at most %d cases together", c->text->path, OB_LIST_CASES);
	for (; n > 0 && c->row > 0 && (all[n - 1]->row > c->row || all[n - 1]->row == 0); n--)
		all[n] = all[n - 1];
	all[n] = c;
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
