// Commands of viewers: their meaning, and refusal of all other input.
#include "check.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/random.h"
#include "serve/command.h"

static bool reads(const char *json, ob_command *c)
{
	ob_error e = { "" };
	bool fine = ob_command_read(c, json, strlen(json), &e);
	CHECK(fine || *e.text);
	return fine;
}

static void test_meaning(void)
{
	ob_command c;
	CHECK(reads("{\"do\":\"create\",\"shape\":\"box\",\"size\":[0.5,1,1.5],\"at\":[1,-2,3e0],\"mass\":7,"
		    "\"velocity\":[0,0,-1],"
		    "\"colour\":[1,0,0.5],\"friction\":0.25,\"restitution\":0.5,\"attitude\":[0,0,0,1],\"name\":"
		    "\"B\\u00e4r\"}",
		    &c));
	const ob_passport *p = &c.request[0].def.passport;
	CHECK(c.request[0].kind == OB_REQUEST_ADD && p->shape == OB_SHAPE_BOX && p->size.y == 1 && p->size.z == 1.5 &&
	      p->mass == 7);
	CHECK(c.request[0].def.state.pose.p.y == -2 && c.request[0].def.state.v.z == -1 &&
	      c.request[0].def.state.pose.q.z == 1 && p->colour[2] == .5f);
	CHECK(p->friction == .25 && p->restitution == .5 && strcmp(p->name, "B\xc3\xa4r") == 0 &&
	      isinf(c.request[0].def.dies));
	CHECK(reads("{\"do\":\"create\",\"shape\":\"sphere\",\"size\":[1,0,0],\"at\":[0,0,9],\"mass\":1}", &c));
	CHECK(strcmp(c.request[0].def.passport.name, "sphere") == 0 && c.request[0].def.passport.friction == .5 &&
	      c.request[0].def.state.pose.q.w == 1);
	// small numbers as written by a page
	CHECK(reads("{\"do\":\"create\",\"shape\":\"sphere\",\"size\":[1,0,0],\"at\":[-0.000123456789012345678,1e-7,"
		    "1.25E+2],\"mass\":0.30000000000000000000000001e1,\"name\":\"\\\"0.000000000000000000000012345\"}",
		    &c));
	CHECK_NEAR(c.request[0].def.state.pose.p.x, -0.000123456789012345678, 1e-16);
	CHECK(c.request[0].def.state.pose.p.y == 1e-7 && c.request[0].def.state.pose.p.z == 125 &&
	      c.request[0].def.passport.mass == 3);
	CHECK(strcmp(c.request[0].def.passport.name, "\"0.000000000000000000000012345") == 0);
	CHECK(reads(" {\"do\":\"remove\", \"id\":12, \"generation\":3} ", &c));
	CHECK(c.request[0].kind == OB_REQUEST_REMOVE && c.requests == 1 && c.request[0].id == 12 &&
	      c.request[0].generation == 3);
	CHECK(reads("{\"do\":\"drag\",\"id\":12,\"generation\":3,\"target\":[1,2,3],\"point\":[0.1,0,0]}", &c));
	const ob_request *q = &c.request[0];
	CHECK(q->kind == OB_REQUEST_DRAG && q->id == 12 && q->target.z == 3 && q->point.x == .1 && q->frequency == 3);
	CHECK(reads("{\"do\":\"edit\",\"id\":12,\"generation\":3,\"velocity\":[1,2,3],\"friction\":0.1}", &c));
	CHECK(c.requests == 2 && q->kind == OB_REQUEST_STATE && isnan(q->state.pose.p.x) && isnan(q->state.pose.q.w));
	CHECK(q->state.v.y == 2 && isnan(q->state.w.x) && c.request[1].kind == OB_REQUEST_FRICTION);
	CHECK(c.request[1].friction == .1 && c.request[1].id == 12);
	CHECK(reads("{\"do\":\"release\"}", &c) && q->kind == OB_REQUEST_RELEASE && q->id == UINT32_MAX);
	CHECK(reads("{\"do\":\"message\",\"id\":12,\"generation\":3,\"text\":\"hop\"}", &c) && q->bytes > 3);
	CHECK(reads("{\"do\":\"message\",\"id\":12,\"generation\":3,\"text\":\" walk 1  -0.5 \"}", &c));
	unsigned char words[64];
	uint32_t bytes = 0;
	CHECK(ob_scene_put_value("walk", words, &bytes, sizeof words) &&
	      ob_scene_put_value("1", words, &bytes, sizeof words) &&
	      ob_scene_put_value("-0.5", words, &bytes, sizeof words));
	CHECK(q->bytes == bytes && memcmp(q->values, words, bytes) == 0);
	CHECK(reads("{\"do\":\"set\",\"name\":\"n\",\"value\":12.5}", &c) && c.request[0].kind == OB_REQUEST_SET &&
	      c.requests == 1);
	CHECK(q->kind == OB_REQUEST_SET && strcmp((const char *)q->values, "n=12.5") == 0);
	CHECK(reads("{\"do\":\"seed\",\"value\":7}", &c) && q->kind == OB_REQUEST_SEED && q->seed == 7);
	CHECK(!reads("{\"do\":\"seed\",\"value\":.5}", &c) && !reads("{\"do\":\"seed\",\"value\":-1}", &c));
	CHECK(reads("{\"do\":\"save\"}", &c) && q->kind == OB_REQUEST_SAVE && !q->values[0]);
	CHECK(!reads("{\"do\":\"save\",\"name\":\"/etc/passwd\"}", &c));
	CHECK(reads("{\"do\":\"energy\",\"on\":true}", &c) && c.request[0].kind == OB_LOOK_ENERGY && c.request[0].on);
	CHECK(reads("{\"do\":\"restart\"}", &c) && q->kind == OB_REQUEST_RESTART && c.requests == 1);
	CHECK(reads("{\"do\":\"pause\"}", &c) && c.requests == 1 && q->kind == OB_REQUEST_PAUSE);
	CHECK(reads("{\"do\":\"step\"}", &c) && q->kind == OB_REQUEST_STEP && q->steps == 1);
	CHECK(reads("{\"do\":\"step\",\"steps\":25}", &c) && q->steps == 25);
	CHECK(reads("{\"do\":\"rate\",\"rate\":0.25}", &c) && q->kind == OB_REQUEST_RATE && q->rate == .25);
	CHECK(reads("{\"do\":\"until\",\"value\":2.5}", &c) && q->kind == OB_REQUEST_UNTIL && q->until == 2.5);
	CHECK(reads("{\"do\":\"kick\",\"id\":1,\"generation\":1,\"impulse\":[1,2,3],\"twist\":[0,0,4]}", &c));
	CHECK(q->kind == OB_REQUEST_KICK && q->force.y == 2 && q->twist.z == 4);
	CHECK(reads("{\"do\":\"edit\",\"id\":1,\"generation\":1,\"surface\":[1,2,3],\"force\":[0,0,4]}", &c));
	CHECK(c.requests == 2 && q->kind == OB_REQUEST_SURFACE && q->surface_velocity.z == 3);
	CHECK(c.request[1].kind == OB_REQUEST_FORCE && c.request[1].force.z == 4 && c.request[1].id == 1);
	CHECK(reads("{\"do\":\"edit\",\"id\":1,\"generation\":1,\"at\":[1,2,3],\"attitude\":[0.6,0.8,0,0],\"velocity\":"
		    "[1,2,3],"
		    "\"spin\":[0,0,1],\"friction\":0.5,\"colour\":[0.1,0.2,0.3],\"surface\":[1,0,0],\"force\":[0,0,4]}",
		    &c)); // all lists that a command can have
	CHECK(c.request[c.requests - 1].force.z == 4);
	CHECK(reads("{\"do\":\"motor\",\"name\":\"elbow\",\"value\":-1}", &c) && q->kind == OB_REQUEST_MOTOR);
	CHECK(strcmp((const char *)q->values, "elbow") == 0 && q->motor == -1);
	CHECK(reads("{\"do\":\"unjoin\",\"name\":\"elbow\"}", &c) && q->kind == OB_REQUEST_UNJOIN);
	CHECK(reads("{\"do\":\"path\",\"id\":1,\"generation\":1,\"points\":[1,2,3,4,5,6,7,8],\"loop\":true}", &c));
	CHECK(q->kind == OB_REQUEST_PATH && q->path.points == 2 && q->path.loop == 1 && q->path.turns == 0);
	CHECK(q->path.point[1].t == 5 && q->path.point[1].p.z == 8);
	CHECK(reads("{\"do\":\"contacts\",\"on\":true}", &c) && c.request[0].on);
	CHECK(reads("{\"do\":\"joints\",\"on\":true}", &c) && c.request[0].on && c.request[0].kind == OB_LOOK_JOINTS);
	CHECK(reads("{\"do\":\"inspect\"}", &c) && c.request[0].id == UINT32_MAX);
}

#define BOX "\"do\":\"create\",\"shape\":\"box\",\"size\":[1,1,1],\"at\":[0,0,0],\"mass\":1"

static void test_nonsense(void)
{
	static const char *const lines[] = {
		"",
		"{",
		"}",
		"[]",
		"7",
		"null",
		"\"pause\"",
		"{}",
		"{\"do\":7}",
		"{\"do\":\"\"}",
		"{\"do\":\"explode\"}",
		"{\"do\":\"pause\"",
		"{\"do\":\"pause\"}}",
		"{\"do\":\"pause\",\"do\":\"pause\"}",
		"{\"do\":[\"pause\"]}",
		"{\"do\":\"pause\",\"id\":1}",
		"{\"do\":{\"do\":\"pause\"}}",
		"{\"do\":\"remove\",\"id\":1}",
		"{\"do\":\"remove\",\"id\":-1,\"generation\":1}",
		"{\"do\":\"remove\",\"id\":1e99,\"generation\":1}",
		"{\"do\":\"drag\",\"id\":1,\"generation\":1}",
		"{\"do\":\"drag\",\"id\":1,\"generation\":1,\"target\":[1,2]}",
		"{\"do\":\"edit\",\"id\":1,\"generation\":1}",
		"{\"do\":\"edit\",\"id\":1,\"generation\":1,\"attitude\":[0,0,0,0]}",
		"{\"do\":\"edit\",\"id\":1,\"generation\":1,\"mass\":1}",
		"{\"do\":\"message\",\"id\":1,\"generation\":1,\"text\":7}",
		"{\"do\":\"message\",\"id\":1,\"generation\":1,\"text\":\"  \"}",
		"{\"do\":\"set\",\"name\":\"n\"}",
		"{\"do\":\"set\",\"name\":\"n\",\"value\":[1]}",
		"{\"do\":\"set\",\"name\":\"n\",\"value\":1e999}",
		"{\"do\":\"kill\",\"id\":1}",
		"{\"do\":\"step\",\"steps\":0}",
		"{\"do\":\"until\"}",
		"{\"do\":\"motor\",\"name\":\"elbow\"}",
		"{\"do\":\"kick\",\"id\":1,\"generation\":1,\"twist\":[0,0,1]}",
		"{\"do\":\"path\",\"id\":1,\"generation\":1,\"points\":[]}",
		"{\"do\":\"path\",\"id\":1,\"generation\":1,\"points\":[1,2,3]}",
		"{\"do\":\"path\",\"id\":1,\"generation\":1,\"points\":7}",
		"{\"do\":\"path\",\"id\":1,\"generation\":1,\"points\":[[1,2,3,4]]}",
		"{\"do\":\"path\",\"id\":1,\"generation\":1,\"points\":[1,2,3,4],\"on\":true}",
		"{\"do\":\"rate\",\"rate\":-1}",
		"{\"do\":\"contacts\",\"on\":1}",
		"{\"do\":\"contacts\",\"on\":null}",
		"{" BOX ",\"shape\":\"box\"}",
		"{" BOX ",\"what\":1}",
		"{" BOX ",\"velocity\":[1,2]}",
		"{" BOX ",\"velocity\":[1,2,3,4]}",
		"{" BOX ",\"velocity\":[[1],2,3]}",
		"{" BOX ",\"velocity\":1}",
		"{" BOX ",\"velocity\":[1,2,1e300]}",
		"{" BOX ",\"velocity\":[1,2,1e999]}",
		"{" BOX ",\"spin\":[0,0,1e9]}",
		"{\"do\":\"create\",\"shape\":\"box\",\"size\":[1,1,1e-160],\"at\":[0,0,0],\"mass\":1}",
		"{\"do\":\"create\",\"shape\":\"box\",\"size\":[1,1,1e160],\"at\":[0,0,0],\"mass\":1}",
		"{\"do\":\"create\",\"shape\":\"sphere\",\"size\":[1e-7,0,0],\"at\":[0,0,0],\"mass\":1}",
		"{\"do\":\"create\",\"shape\":\"cylinder\",\"size\":[1,1,0],\"at\":[0,0,0],\"mass\":1e-13}",
		"{\"do\":\"create\",\"shape\":\"sphere\",\"size\":[1,0,0],\"at\":[1e8,0,0],\"mass\":1}",
		"{" BOX ",\"velocity\":[1,2,\"3\"]}",
		"{" BOX ",\"restitution\":2}",
		"{" BOX ",\"friction\":[1]}",
		"{" BOX ",\"attitude\":[0,0,0,0]}",
		"{" BOX ",\"name\":\"a\\u001bb\"}",
		"{" BOX ",\"name\":\"a\xc2\x9b"
		"b\"}",
		"{" BOX ",\"name\":\"a\xff\"}",
		"{" BOX ",\"name\":\"0123456789012345678901234567890123456789012345678901234567890\"}",
		"{\"do\":\"create\",\"shape\":\"plane\",\"size\":[1,1,1],\"at\":[0,0,0],\"mass\":1}",
	};
	ob_command c;
	for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
		if (reads(lines[i], &c))
			fprintf(stderr, "taken: %s\n", lines[i]);
		CHECK(!reads(lines[i], &c) && c.requests == 0);
	}
}

// Random bytes, and commands with random changes
static void test_bytes(void)
{
	static const char model[] = "{" BOX ",\"velocity\":[1,2,3],\"name\":\"abc\"}";
	uint64_t seed = 1;
	ob_command c;
	ob_error e;
	for (int i = 0; i < 100000; i++) {
		char text[256];
		size_t n = sizeof model - 1;
		memcpy(text, model, n);
		if (i % 2)
			n = ob_splitmix(&seed) % sizeof text;
		for (size_t k = 0; k < n; k++) {
			if (i % 2 || ob_splitmix(&seed) % 30 == 0)
				text[k] = (char)ob_splitmix(&seed);
		}
		char *copy = malloc(n + 1); // exact size: a sanitizer detects reads behind it
		memcpy(copy, text, n);
		copy[n] = 0;
		if (ob_command_read(&c, copy, n, &e) && c.request[0].kind == OB_REQUEST_ADD)
			CHECK(isfinite(c.request[0].def.state.v.x) &&
			      memchr(c.request[0].def.passport.name, 0, OB_NAME_MAX));
		free(copy);
	}
	char *long_one = malloc(OB_COMMAND_BYTES_MAX + 2);
	memset(long_one, ' ', OB_COMMAND_BYTES_MAX + 2);
	CHECK(!ob_command_read(&c, long_one, OB_COMMAND_BYTES_MAX + 1, &e));
	free(long_one);
}

int main(void)
{
	test_meaning();
	test_nonsense();
	test_bytes();
	return check_end();
}
