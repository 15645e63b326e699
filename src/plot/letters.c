#include "plot/letters.h"

#include <string.h>

#include "base/utf8.h"

// Thousandths of the font size, by code point: U+0020 to U+007E, then U+00A0 to U+00FF (Adobe's metrics of Helvetica
// and Helvetica-Bold, 1985).
static const unsigned short widths[2][191] = {
	{
		278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278,  333,  278, 278, 556, 556, 556, 556,
		556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667,  667, 722, 722, 667, 611, 778,
		722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667, 611,  722,  667, 944, 667, 667, 611, 278,
		278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278, 556, 556,  222,  222, 500, 222, 833, 556, 556,
		556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260,  334,  584, 278, 333, 556, 556, 556,
		556, 260, 556, 333, 737, 370, 556, 584, 333, 737, 552, 400, 549,  333,  333, 333, 576, 537, 278, 333,
		333, 365, 556, 834, 834, 834, 611, 667, 667, 667, 667, 667, 667,  1000, 722, 667, 667, 667, 667, 278,
		278, 278, 278, 722, 722, 778, 778, 778, 778, 778, 584, 778, 722,  722,  722, 722, 667, 667, 611, 556,
		556, 556, 556, 556, 556, 889, 500, 556, 556, 556, 556, 278, 278,  278,  278, 556, 556, 556, 556, 556,
		556, 556, 549, 611, 556, 556, 556, 556, 500, 556, 500,
	},
	{
		278, 333, 474, 556, 556, 889, 722, 238, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556, 556,
		556, 556, 556, 556, 556, 556, 333, 333, 584, 584, 584, 611, 975, 722,  722, 722, 722, 667, 611, 778,
		722, 278, 556, 722, 611, 833, 722, 778, 667, 778, 722, 667, 611, 722,  667, 944, 667, 667, 611, 333,
		278, 333, 584, 556, 333, 556, 611, 556, 611, 556, 333, 611, 611, 278,  278, 556, 278, 889, 611, 611,
		611, 611, 389, 556, 333, 611, 556, 778, 556, 556, 500, 389, 280, 389,  584, 278, 333, 556, 556, 556,
		556, 280, 556, 333, 737, 370, 556, 584, 333, 737, 552, 400, 549, 333,  333, 333, 576, 556, 278, 333,
		333, 365, 556, 834, 834, 834, 611, 722, 722, 722, 722, 722, 722, 1000, 722, 667, 667, 667, 667, 278,
		278, 278, 278, 722, 722, 778, 778, 778, 778, 778, 584, 778, 722, 722,  722, 722, 667, 667, 611, 556,
		556, 556, 556, 556, 556, 889, 556, 556, 556, 556, 556, 278, 278, 278,  278, 611, 611, 611, 611, 611,
		611, 611, 549, 611, 611, 611, 611, 611, 556, 611, 556,
	},
};

static const struct {
	unsigned code;
	unsigned short width;
} others[] = {
	{ 0x3b8, 556 },   { 0x3bc, 612 },   { 0x3c0, 766 },  { 0x3c9, 845 }, // theta, mu, pi, omega
	{ 0x2013, 556 },  { 0x2014, 1000 }, { 0x2019, 278 }, { 0x2022, 350 },
	{ 0x2026, 1000 }, // dashes, ', bullet, ...
	{ 0x2192, 1000 }, { 0x2212, 584 },  { 0x221e, 713 }, // arrow, minus, infinity
	{ 0x2248, 549 },  { 0x2260, 549 },  { 0x2264, 549 }, { 0x2265, 549 }, // about, not equal, <=, >=
};
enum { WIDTH_UNKNOWN = 650 };
static const char ellipsis[] = "\u2026";

// Of the character at s, as it is drawn: what XML does not allow is replaced, too.
static uint32_t decode(const char *s, size_t *bytes)
{
	uint32_t code = ob_utf8_decode(s, bytes);
	return (code & 0xfffe) == 0xfffe ? OB_UTF8_REPLACEMENT : code;
}

static double letter_width(uint32_t code, bool bold)
{
	if (code >= 0x20 && code < 0x7f)
		return widths[bold][code - 0x20];
	if (code >= 0xa0 && code <= 0xff)
		return widths[bold][95 + code - 0xa0];
	for (size_t i = 0; i < sizeof others / sizeof *others; i++)
		if (others[i].code == code)
			return others[i].width;
	return WIDTH_UNKNOWN;
}

double ob_letters_width(const char *text, double size, bool bold)
{
	double sum = 0;
	for (size_t bytes; *text; text += bytes)
		sum += letter_width(decode(text, &bytes), bold);
	return sum * size / 1000;
}

void ob_letters_clean(const char *text, char *to, size_t room)
{
	size_t used = 0;
	for (size_t bytes; *text; text += bytes) {
		uint32_t code = decode(text, &bytes);
		const char *letter = code == OB_UTF8_REPLACEMENT                            ? "?"
				     : code < 0x20 || (code >= 0x7f && code < 0xa0) ? " "
										    : text;
		size_t length = letter == text ? bytes : 1;
		if (used + length >= room)
			break;
		memcpy(to + used, letter, length);
		used += length;
	}
	to[used] = 0;
}

// Bytes of text that fit into width px; with "words" only up to the end of a word, if that is not nothing.
static size_t fitting(const char *text, double width, double size, bool bold, bool words)
{
	size_t fit = 0, word = 0;
	double sum = 0;
	for (size_t at = 0, bytes; text[at]; at += bytes) {
		sum += letter_width(decode(text + at, &bytes), bold) * size / 1000;
		if (sum > width)
			return words && word ? word : fit;
		fit = at + bytes;
		if (text[fit] == ' ')
			word = fit;
	}
	return fit;
}

bool ob_letters_line(const char **text, double width, double size, bool bold, bool last, char *line, size_t room)
{
	const char *from = *text + strspn(*text, " ");
	if (!*from)
		return false;
	bool cut = last && ob_letters_width(from, size, bold) > width;
	double taken = cut ? ob_letters_width(ellipsis, size, bold) : 0;
	size_t length = fitting(from, width - taken, size, bold, !cut);
	if (!length)
		decode(from, &length);
	if (length > room - sizeof ellipsis) {
		cut = true;
		for (length = room - sizeof ellipsis; length && ((unsigned char)from[length] & 0xc0) == 0x80;)
			length--;
	}
	memcpy(line, from, length);
	memcpy(line + length, cut ? ellipsis : "", cut ? sizeof ellipsis : 1);
	*text = cut ? from + strlen(from) : from + length;
	return true;
}
