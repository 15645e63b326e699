// -D name=value reaches param(name, default) in the type of the default, a number as any number unless the scene says
// whole = true, or is refused with the names that exist.
#include "check.h"
#include "text.h"

// The radius tells what param gave.
static double value(const char *text, const char *define)
{
	ob_error e = { "" };
	ob_scene_options o = { .defines = &define, .define_count = 1 };
	ob_scene *s = load_bytes(text, strlen(text), &o, &e);
	double x = s ? s->object[0].passport.size.x : NAN;
	if (!s)
		fprintf(stderr, "  %s\n", e.text);
	ob_scene_free(s);
	return x;
}

static void refused(const char *text, const char *define, const char *expected)
{
	ob_error e = { "" };
	ob_scene_options o = { .defines = &define, .define_count = 1 };
	CHECK(!load_bytes(text, strlen(text), &o, &e));
	CHECK(strstr(e.text, expected) && !strchr(e.text, '\n'));
	if (!strstr(e.text, expected))
		fprintf(stderr, "  expected %s\n  got %s\n", expected, e.text);
}

static const char whole[] = "sphere { radius = param('n', 100, { whole = true }), mass = 1 }";
static const char number[] = "sphere { radius = param('p', 1), mass = 1 }";
static const char real[] = "sphere { radius = param('r', .5, { min = .1, max = 1e6 }), mass = 1 }";
static const char text[] = "sphere { radius = #param('t', 'ab') }";
static const char flag[] = "sphere { radius = param('f', false) and 2 or 1 }";
static const char choice[] = "sphere { radius = #param('c', 'one', { 'one', 'three' }) }";

#define WHOLE_EXPECTED ":1: param.n: expected a whole number (12, 3*4), as the scene says whole = true, got "

int main(void)
{
	CHECK(value(whole, "n=7") == 7 && value(whole, "n=1e3") == 1000 && value(whole, "n=0x10") == 16);
	CHECK(value(real, "r=.25") == .25 && value(real, "r=3") == 3);
	CHECK(value(real, "r=1/3") == 1. / 3 && value(real, "r=-(1 - 3)/4") == .5 && value(real, "r= 2^10") == 1024);
	CHECK(value(real, "r=pi/6") == M_PI / 6 && value(real, "r=math.sqrt(2)") == sqrt(2) &&
	      value(real, "r=sqrt(4)") == 2);
	CHECK(value(whole, "n=3*4") == 12 && value(whole, "n=6/2") == 3 && value(whole, "n=7//2") == 3);
	CHECK(value(text, "t=1/3") == 3);
	CHECK(value("sphere { radius = math.type(param('r', .5)) == 'float' and 1 or 2 }", "r=3") == 1);
	CHECK(value("sphere { radius = math.type(param('r', 5)) == 'integer' and 1 or 2 }", "r=3e0") == 1);
	CHECK(value("sphere { radius = math.type(param('r', 5)) == 'float' and 1 or 2 }", "r=.5") == 1);
	CHECK(value("sphere { radius = math.type(param('r', 5., { whole = true })) == 'integer' and 1 or 2 }", "r=3") ==
	      1);
	CHECK(value(number, "p=.02") == .02 && value(number, "p=1/3") == 1. / 3 && value(number, "p=7") == 7);
	CHECK(value("sphere { radius = param('p', 1, { min = 0, max = 2 }), mass = 1 }", "p=.5") == .5);
	CHECK(value(text, "t=hello") == 5 && value(text, "t=a=b") == 3);
	CHECK(value(flag, "f=true") == 2 && value(flag, "f=false") == 1);
	CHECK(value(choice, "c=three") == 5);
	const char *twice[] = { "n=1", "n=2" };
	ob_scene_options o = { .defines = twice, .define_count = 2 };
	ob_scene *s = load_bytes(whole, strlen(whole), &o, NULL);
	CHECK(s && s->object[0].passport.size.x == 2);
	ob_scene_free(s);

	refused(whole, "n=2.5", WHOLE_EXPECTED "-D n=2.5");
	refused(whole, "n=many", WHOLE_EXPECTED "-D n=many");
	refused(whole, "n=", WHOLE_EXPECTED "-D n=");
	refused(number, "p=many", ":1: param.p: expected a number (.5, 1/3, pi/6), got -D p=many");
	refused(real, "r=1e999", ":1: param.r: expected a number (.5, 1/3, pi/6), got -D r=1e999");
	refused(real, "r=nan", ":1: param.r: expected a number (.5, 1/3, pi/6), got -D r=nan");
	refused(real, "r=1/0", ":1: param.r: expected a number (.5, 1/3, pi/6), got -D r=1/0");
	refused(real, "r=1/", ":1: param.r: expected a number (.5, 1/3, pi/6), got -D r=1/");
	refused(real, "r='1'", ":1: param.r: expected a number (.5, 1/3, pi/6), got -D r='1'");
	refused(real, "r=1, 2", ":1: param.r: expected a number (.5, 1/3, pi/6), got -D r=1, 2");
	refused(real, "r=random()", ":1: param.r: expected a number (.5, 1/3, pi/6), got -D r=random()");
	refused(real, "r=sphere{}", ":1: param.r: expected a number (.5, 1/3, pi/6), got -D r=sphere{}");
	refused(whole, "n=1/3", WHOLE_EXPECTED "-D n=1/3");
	refused(real, "r=(function() while true do end end)()", ":1: param.r: expected a number");
	refused(real, "r=0", ":1: param.r: expected a number of at least 0.1, got 0");
	refused(real, "r=1e7", ":1: param.r: expected a number of at most 1000000, got 10000000");
	refused(flag, "f=yes", ":1: param.f: expected true or false, got -D f=yes");
	refused(choice, "c=two", ":1: param.c: expected \"one\" or \"three\", got \"two\"");
	refused(whole, "m=1", "-D m=1: unknown parameter, did you mean n? The scene has n");
	refused(whole, "speed=1", "-D speed=1: unknown parameter; the scene has n");
	refused("sphere { radius = 1 }", "n=1", "-D n=1: unknown parameter; the scene has none");
	refused(whole, "n", "-D n: expected name=value");
	refused(whole, "=1", "-D =1: expected name=value");
	refused(whole, "n=\n\n", WHOLE_EXPECTED);
	return check_end();
}
