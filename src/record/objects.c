#include "record/objects.h"

#include <stddef.h>
#include <stdlib.h>
#include <string.h>

enum kind { INTEGER, NUMBER, VECTOR, NAME, SHAPE, FLAG };
enum { SHAPE_MAX = 12 };

// A fact of a passport and where it lies in it.
static const struct fact {
	ob_file_label label;
	enum kind kind;
	size_t offset;
} facts[OB_RECORD_FACTS] = {
	{ { "id", "1", NULL, "index of the object in all datasets" }, INTEGER, offsetof(ob_passport, id) },
	{ { "generation", "1", NULL, "grows each time the id is given to another object" },
	  INTEGER,
	  offsetof(ob_passport, generation) },
	{ { "name", "1", NULL, "name given by the scene" }, NAME, offsetof(ob_passport, name) },
	{ { "shape", "1", NULL, "sphere, box, plane, capsule, cylinder; empty: no object" },
	  SHAPE,
	  offsetof(ob_passport, shape) },
	{ { "size", "m", "body",
	    "sphere: radius; box: half extents; capsule and cylinder: radius, half length along body z" },
	  VECTOR,
	  offsetof(ob_passport, size) },
	{ { "mass", "kg", NULL, "0: static" }, NUMBER, offsetof(ob_passport, mass) },
	{ { "inertia", "kg m^2", "body", "principal moments; 0: static" }, VECTOR, offsetof(ob_passport, inertia) },
	{ { "friction", "1", NULL, "Coulomb's coefficient; a pair uses the geometric mean" },
	  NUMBER,
	  offsetof(ob_passport, friction) },
	{ { "restitution", "1", NULL, "a pair uses the larger of the two" },
	  NUMBER,
	  offsetof(ob_passport, restitution) },
	{ { "static", "1", NULL, "1: never moves" }, FLAG, offsetof(ob_passport, flags) },
};

static hid_t type_of(enum kind kind)
{
	switch (kind) {
	case NAME:
		return ob_file_string_type(OB_NAME_MAX);
	case SHAPE:
		return ob_file_string_type(SHAPE_MAX);
	case NUMBER:
	case VECTOR:
		return H5Tcopy(H5T_NATIVE_DOUBLE);
	case INTEGER:
		return H5Tcopy(H5T_NATIVE_UINT32);
	case FLAG:
		break;
	}
	return H5Tcopy(H5T_NATIVE_UINT8);
}

static size_t bytes_of(enum kind kind)
{
	static const size_t bytes[] = { 4, 8, 24, OB_NAME_MAX, SHAPE_MAX, 1 };
	return bytes[kind];
}

bool ob_record_objects_create(ob_record_objects *o, hid_t file, uint32_t count)
{
	o->count = count;
	for (int i = 0; i < OB_RECORD_FACTS; i++)
		o->set[i] = H5I_INVALID_HID;
	o->group = H5Gcreate2(file, "objects", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
	o->written = calloc(count, sizeof *o->written);
	if (o->group < 0 || !o->written)
		return false;
	for (int i = 0; i < OB_RECORD_FACTS; i++) {
		hsize_t dims[2] = { count, 3 };
		hid_t type = type_of(facts[i].kind);
		o->set[i] = ob_file_dataset(o->group, &facts[i].label, type, facts[i].kind == VECTOR ? 2 : 1, dims, 0,
					    NULL);
		H5Tclose(type);
		if (o->set[i] < 0)
			return false;
	}
	return true;
}

static void extract(const struct fact *f, const ob_passport *p, char *to)
{
	static const char shapes[][SHAPE_MAX] = { "", "sphere", "box", "plane", "capsule", "cylinder" };
	if (f->kind == SHAPE)
		memcpy(to, shapes[p->shape <= OB_SHAPE_CYLINDER ? p->shape : 0], SHAPE_MAX);
	else if (f->kind == FLAG)
		*to = (p->flags & OB_OBJECT_STATIC) != 0;
	else
		memcpy(to, (const char *)p + f->offset, bytes_of(f->kind));
}

static bool write_fact(const ob_record_objects *o, int i, char *buffer)
{
	hid_t type = type_of(facts[i].kind);
	for (uint32_t id = 0; id < o->count; id++)
		extract(&facts[i], &o->written[id], buffer + id * bytes_of(facts[i].kind));
	bool ok = H5Dwrite(o->set[i], type, H5S_ALL, H5S_ALL, H5P_DEFAULT, buffer) >= 0;
	H5Tclose(type);
	return ok;
}

bool ob_record_objects_update(ob_record_objects *o, const ob_snapshot *s)
{
	bool changed = false, ok = true;
	for (uint32_t id = 0; id < o->count; id++) {
		// an object that has gone stays entered: its past is in the file
		if (id >= s->count || !(s->passport[id].flags & OB_OBJECT_PRESENT) ||
		    memcmp(&o->written[id], &s->passport[id], sizeof *o->written) == 0)
			continue;
		o->written[id] = s->passport[id];
		changed = true;
	}
	if (!changed)
		return true;
	char *buffer = malloc((size_t)o->count * OB_NAME_MAX);
	for (int i = 0; i < OB_RECORD_FACTS && ok; i++)
		ok = buffer && write_fact(o, i, buffer);
	free(buffer);
	return ok;
}

bool ob_record_objects_finish(ob_record_objects *o)
{
	bool ok = true;
	for (int i = 0; i < OB_RECORD_FACTS; i++)
		if (o->set[i] > 0)
			ok &= H5Dclose(o->set[i]) >= 0;
	if (o->group > 0)
		ok &= H5Gclose(o->group) >= 0;
	free(o->written);
	return ok;
}
