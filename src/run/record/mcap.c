#include "record/mcap.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/clock.h"
#include "record/foxglove.h"

enum { HEADER = 1, FOOTER = 2, SCHEMA = 3, CHANNEL = 4, MESSAGE = 5, DATA_END = 15 }; // record types of MCAP
static const char magic[8] = { (char)0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n' };

typedef struct writer {
	FILE *file;
	const ob_scene *scene;
	ob_bytes record, message; // their memory is kept for the next
	uint32_t *numbers; // [channels]: messages so far
	uint64_t now; // ns
	ob_foxglove_view view;
} writer;

// Numbers are little-endian, as this machine's.
static void put_number(ob_bytes *t, uint64_t value, size_t bytes)
{
	ob_bytes_put(t, &value, bytes);
}

static void put_string(ob_bytes *t, const char *s, size_t n)
{
	put_number(t, n, 4);
	ob_bytes_put(t, s, n);
}

static void write_record(writer *w, int type)
{
	const unsigned char opcode = (unsigned char)type;
	const uint64_t size = w->record.size;
	fwrite(&opcode, 1, 1, w->file);
	fwrite(&size, sizeof size, 1, w->file);
	fwrite(w->record.bytes, 1, w->record.size, w->file);
	w->record.size = 0;
}

// Writes the message of a channel, of this instant (ns), read now.
static void write_message(writer *w, uint32_t channel, uint64_t ns)
{
	ob_bytes *m = &w->record;
	put_number(m, channel + 1, 2);
	put_number(m, w->numbers[channel]++, 4);
	put_number(m, w->now, 8);
	put_number(m, ns, 8);
	ob_bytes_put(m, w->message.bytes, w->message.size);
	write_record(w, MESSAGE);
	w->message.size = 0;
}

// ---- head and end

// Each channel has a schema of the same number: names differ, descriptions do not.
static void write_channel(writer *w, uint32_t number, const ob_channel *c, const ob_bytes *schemas)
{
	ob_bytes *m = &w->record;
	put_number(m, number + 1, 2);
	put_string(m, c->schema, strlen(c->schema));
	put_string(m, "protobuf", 8);
	put_string(m, schemas->bytes, schemas->size);
	write_record(w, SCHEMA);
	put_number(m, number + 1, 2);
	put_number(m, number + 1, 2);
	put_string(m, c->topic, strlen(c->topic));
	put_string(m, "protobuf", 8);
	put_number(m, 0, 4); // no metadata
	write_record(w, CHANNEL);
}

static bool write_head(writer *w, const char *version)
{
	char library[64];
	ob_channel c;
	ob_bytes schemas = { 0 };
	uint32_t channels = 0;
	const int n = snprintf(library, sizeof library, "obsim %s", version);
	fwrite(magic, 1, sizeof magic, w->file);
	put_string(&w->record, "", 0);
	put_string(&w->record, library, (size_t)n < sizeof library ? (size_t)n : sizeof library - 1);
	write_record(w, HEADER);
	ob_foxglove_describe(&schemas);
	for (; ob_channel_get(w->scene->sensor, w->scene->sensors, channels, &c); channels++)
		write_channel(w, channels, &c, &schemas);
	w->record.failed |= schemas.failed;
	free(schemas.bytes);
	w->numbers = calloc(channels, sizeof *w->numbers);
	return w->numbers;
}

static void write_end(writer *w)
{
	put_number(&w->record, 0, 4); // no checksum
	write_record(w, DATA_END);
	put_number(&w->record, 0, 8); // no summary
	put_number(&w->record, 0, 8);
	put_number(&w->record, 0, 4);
	write_record(w, FOOTER);
	fwrite(magic, 1, sizeof magic, w->file);
}

// ---- states

static void write_samples(writer *w, const ob_recorded_sample *s, size_t n)
{
	ob_channel c;
	for (size_t k = 0; k < n; k++) {
		const uint64_t ns = (uint64_t)llround(1e9 * s[k].time);
		for (uint32_t i = 2; ob_channel_get(w->scene->sensor, w->scene->sensors, i, &c); i++) {
			if (c.sensor != s[k].sensor)
				continue;
			ob_foxglove_sample(&w->message, &c, &w->scene->sensor[c.sensor], ns, s[k].value);
			write_message(w, i, ns);
		}
	}
}

static bool write_states(writer *w, ob_recording *r, const char *record, double seconds, ob_error *e)
{
	const double until = ob_clock_process_cpu() + seconds;
	bool ended = false;
	while (ob_recording_next(r, &ended, e)) {
		const ob_snapshot *s = ob_recording_state(r);
		size_t samples;
		const ob_recorded_sample *sample = ob_recording_samples(r, &samples);
		w->now = (uint64_t)llround(1e9 * s->time);
		if (!ob_foxglove_view_fit(&w->view, s))
			return ob_fail(e, "%s: out of memory", record);
		if (ob_foxglove_scene(&w->message, &w->view, w->scene, s, w->now))
			write_message(w, OB_CHANNEL_SCENE, w->now);
		if (ob_foxglove_poses(&w->message, &w->view, w->scene, s, w->now))
			write_message(w, OB_CHANNEL_POSES, w->now);
		write_samples(w, sample, samples);
		if (w->record.failed || w->message.failed)
			return ob_fail(e, "%s: out of memory", record);
		if (ob_clock_process_cpu() > until)
			return ob_fail(e, "%s: it takes more than %g s of CPU to write it: --patience %g allows more",
				       record, seconds, 4 * seconds);
		if (ferror(w->file))
			return true; // close tells why
	}
	return ended;
}

bool ob_mcap_write(ob_recording *r, const char *record, const char *path, double seconds, ob_error *e)
{
	writer w = { .file = fopen(path, "wbe"), .scene = &ob_recording_get_info(r)->scene };
	if (!w.file)
		return ob_fail(e, "%s: %s", path, strerror(errno));
	const bool fine = (write_head(&w, ob_recording_get_info(r)->version) || ob_fail(e, "out of memory")) &&
			  write_states(&w, r, record, seconds, e);
	write_end(&w);
	errno = 0;
	const bool broken = ferror(w.file) != 0;
	const bool whole = fclose(w.file) == 0 && !broken;
	free(w.record.bytes);
	free(w.message.bytes);
	free(w.numbers);
	ob_foxglove_view_finish(&w.view);
	return fine && (whole || ob_fail(e, "%s: %s", path, errno ? strerror(errno) : "not all of it was written"));
}
