#include "plot/font.h"

#include <string.h>

#include "base/utf8.h"

// Thousandths of the font size, by code point: U+0020 to U+007E, then U+00A0 to U+00FF. The larger of the widths in
// Helvetica (Adobe's metrics, 1985) and in DejaVu Sans 2.37, each regular and bold.
// clang-format off
static const unsigned short widths[2][191] = {
	{
		318, 401, 460, 838, 637, 951, 780, 275, 391, 391, 500, 838, 318, 361, 318, 337, 637, 637,
		637, 637, 637, 637, 637, 637, 637, 637, 337, 337, 838, 838, 838, 556, 1015, 685, 687, 722,
		771, 667, 611, 778, 752, 295, 500, 667, 558, 863, 749, 788, 667, 788, 722, 667, 611, 732,
		685, 989, 686, 667, 686, 391, 337, 391, 838, 556, 500, 613, 635, 550, 635, 616, 353, 635,
		634, 278, 278, 580, 278, 975, 634, 612, 635, 635, 412, 521, 393, 634, 592, 818, 592, 592,
		525, 637, 337, 637, 838, 318, 401, 637, 637, 637, 637, 337, 556, 500, 1000, 472, 612, 838,
		361, 1000, 552, 500, 838, 401, 401, 500, 637, 637, 318, 500, 401, 472, 612, 970, 970, 970,
		611, 685, 685, 685, 685, 685, 685, 1000, 722, 667, 667, 667, 667, 295, 295, 295, 295, 775,
		749, 788, 788, 788, 788, 788, 838, 788, 732, 732, 732, 732, 667, 667, 630, 613, 613, 613,
		613, 613, 613, 982, 550, 616, 616, 616, 616, 278, 278, 278, 278, 612, 634, 612, 612, 612,
		612, 612, 838, 612, 634, 634, 634, 634, 592, 635, 592,
	},
	{
		349, 457, 521, 838, 696, 1002, 873, 307, 458, 458, 523, 838, 380, 416, 380, 366, 696, 696,
		696, 696, 696, 696, 696, 696, 696, 696, 400, 400, 838, 838, 838, 611, 1000, 774, 763, 734,
		831, 684, 684, 821, 837, 373, 556, 775, 638, 996, 837, 851, 733, 851, 771, 721, 683, 813,
		774, 1104, 771, 725, 726, 458, 366, 458, 838, 556, 500, 675, 716, 593, 716, 679, 436, 716,
		712, 343, 343, 666, 343, 1042, 712, 688, 716, 716, 494, 596, 479, 712, 652, 924, 646, 652,
		583, 712, 366, 712, 838, 349, 457, 696, 696, 637, 696, 366, 556, 500, 1000, 564, 646, 838,
		416, 1000, 552, 500, 838, 438, 438, 500, 736, 637, 380, 500, 438, 564, 646, 1036, 1036, 1036,
		611, 774, 774, 774, 774, 774, 774, 1085, 734, 684, 684, 684, 684, 373, 373, 373, 373, 838,
		837, 851, 851, 851, 851, 851, 838, 851, 813, 813, 813, 813, 725, 738, 720, 675, 675, 675,
		675, 675, 675, 1048, 593, 679, 679, 679, 679, 343, 343, 343, 343, 688, 712, 688, 688, 688,
		688, 688, 838, 688, 712, 712, 712, 712, 652, 716, 652,
	},
};
// clang-format on

static const struct {
	unsigned code;
	unsigned short width;
} others[] = {
	{ 0x3b8, 688 },   { 0x3bc, 736 },   { 0x3c0, 792 },  { 0x3c9, 870 }, // theta, mu, pi, omega
	{ 0x2013, 556 },  { 0x2014, 1000 }, { 0x2019, 380 }, { 0x2022, 640 }, // dashes, apostrophe, bullet
	{ 0x2026, 1000 }, { 0x2192, 1000 }, { 0x2212, 838 }, { 0x221e, 834 }, // ellipsis, arrow, minus, infinity
	{ 0x2248, 838 },  { 0x2260, 838 },  { 0x2264, 838 }, { 0x2265, 838 }, // about, not equal, <=, >=
};
enum { WIDTH_UNKNOWN = 1000 };
static const char ellipsis[] = "\u2026";

// Code point of the character at s as drawn: replaces characters that XML does not allow, too.
static uint32_t decode(const char *s, size_t *bytes)
{
	uint32_t code = ob_utf8_decode(s, bytes);
	return (code & 0xfffe) == 0xfffe ? OB_UTF8_REPLACEMENT : code;
}

static double advance_of(uint32_t code, bool bold)
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

double ob_font_width(const char *text, double size, bool bold)
{
	double sum = 0;
	for (size_t bytes; *text; text += bytes)
		sum += advance_of(decode(text, &bytes), bold);
	return sum * size / 1000;
}

void ob_font_clean_text(const char *text, char *to, size_t room)
{
	size_t used = 0;
	for (size_t bytes; *text; text += bytes) {
		uint32_t code = decode(text, &bytes);
		const char *letter = code == OB_UTF8_REPLACEMENT                    ? "?"
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

// Number of bytes of text that fit into width px; with "words" only up to the end of a word, unless that gives 0.
static size_t fitting_bytes(const char *text, double width, double size, bool bold, bool words)
{
	size_t fit = 0, word = 0;
	double sum = 0;
	for (size_t at = 0, bytes; text[at]; at += bytes) {
		sum += advance_of(decode(text + at, &bytes), bold) * size / 1000;
		if (sum > width)
			return words && word ? word : fit;
		fit = at + bytes;
		if (text[fit] == ' ')
			word = fit;
	}
	return fit;
}

bool ob_font_fit_line(const char **text, double width, double size, bool bold, bool last, char *line, size_t room)
{
	const char *from = *text + strspn(*text, " ");
	if (!*from)
		return false;
	bool cut = last && ob_font_width(from, size, bold) > width;
	double taken = cut ? ob_font_width(ellipsis, size, bold) : 0;
	size_t length = fitting_bytes(from, width - taken, size, bold, !cut);
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
