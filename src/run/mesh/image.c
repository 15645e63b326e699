// PNG and JPEG through libpng and libjpeg, which leave by longjmp on errors. So data that must be freed lies in a
// structure outside of the function that they leave.
#include "mesh/image.h"

#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <jpeglib.h>
#include <png.h>

#include "base/budget.h"

// Limit of scans of a JPEG: each covers the whole picture.
enum { JPEG_SCANS_MAX = 64 };

// Allocates the pixels, or returns false and e.
static bool make_room(ob_mesh_image *out, uint32_t width, uint32_t height, size_t most, ob_error *e)
{
	if (width > OB_MESH_IMAGE_SIDE_MAX || height > OB_MESH_IMAGE_SIDE_MAX)
		return ob_fail(e, "a picture of it has %u x %u pixels: expected at most %d x %d", width, height,
			       OB_MESH_IMAGE_SIDE_MAX, OB_MESH_IMAGE_SIDE_MAX);
	if ((size_t)width * height > most)
		return ob_fail(e, "its pictures have more than %d pixels", OB_MESH_PIXELS_MAX);
	if (!ob_budget_allows(8 * (uint64_t)width * height, e)) // a decoder holds as much again
		return false;
	*out = (ob_mesh_image){ width, height, malloc(4 * (size_t)width * height) };
	return out->rgba || ob_fail(e, "no memory for it");
}

// ---- PNG

typedef struct png_source {
	const unsigned char *bytes;
	size_t left;
	png_structp png;
	png_infop info;
	png_bytep *row;
	ob_error *e;
} png_source;

static void take_bytes(png_structp png, png_bytep to, size_t size)
{
	png_source *s = png_get_io_ptr(png);
	if (size > s->left)
		png_error(png, "it is cut short");
	memcpy(to, s->bytes, size);
	s->bytes += size;
	s->left -= size;
}

static void ignore_warning(png_structp png, png_const_charp text)
{
	(void)png, (void)text;
}

static _Noreturn void leave_png(png_structp png, png_const_charp text)
{
	png_source *s = png_get_error_ptr(png);
	ob_fail(s->e, "a picture of it is a damaged PNG: %s", text);
	png_longjmp(png, 1);
}

// Converts any format to 8 bits of red, green, blue and alpha.
static void set_rgba(const png_source *s)
{
	png_set_expand(s->png);
	png_set_scale_16(s->png);
	png_set_gray_to_rgb(s->png);
	png_set_add_alpha(s->png, 255, PNG_FILLER_AFTER);
	png_set_interlace_handling(s->png);
	png_read_update_info(s->png, s->info);
}

static bool decode_png(png_source *s, ob_mesh_image *out, size_t most)
{
	if (setjmp(png_jmpbuf(s->png)))
		return false;
	png_set_read_fn(s->png, s, take_bytes);
	png_set_user_limits(s->png, PNG_UINT_31_MAX, PNG_UINT_31_MAX); // make_room checks sizes, with its own message
	// Skips all chunks but those of pixels, palette and transparency. Texts and profiles are compressed, and each
	// may become a thousand times as large.
	png_set_keep_unknown_chunks(s->png, PNG_HANDLE_CHUNK_NEVER, NULL, -1);
	png_read_info(s->png, s->info);
	const png_uint_32 height = png_get_image_height(s->png, s->info);
	if (!make_room(out, png_get_image_width(s->png, s->info), height, most, s->e))
		return false;
	set_rgba(s);
	s->row = malloc(height * sizeof *s->row);
	if (!s->row)
		return ob_fail(s->e, "no memory for it");
	for (png_uint_32 i = 0; i < height; i++)
		s->row[i] = out->rgba + 4 * (size_t)out->width * i;
	png_read_image(s->png, s->row);
	png_read_end(s->png, NULL);
	return true;
}

static bool read_png(ob_mesh_image *out, const unsigned char *bytes, size_t size, size_t most, ob_error *e)
{
	png_source s = { .bytes = bytes, .left = size, .e = e };
	s.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &s, leave_png, ignore_warning);
	s.info = s.png ? png_create_info_struct(s.png) : NULL;
	const bool good = s.info ? decode_png(&s, out, most) : ob_fail(e, "no memory for it");
	png_destroy_read_struct(&s.png, &s.info, NULL);
	free(s.row);
	return good;
}

// ---- JPEG

typedef struct jpeg_source {
	struct jpeg_decompress_struct jpeg;
	struct jpeg_error_mgr errors;
	struct jpeg_progress_mgr progress;
	jmp_buf left_at;
	ob_error *e;
} jpeg_source;

static _Noreturn void leave_jpeg(j_common_ptr jpeg)
{
	jpeg_source *s = jpeg->client_data;
	char text[JMSG_LENGTH_MAX];
	jpeg->err->format_message(jpeg, text);
	ob_fail(s->e, "a picture of it is a damaged JPEG: %s", text);
	longjmp(s->left_at, 1);
}

// Refuses damaged pictures, truncated ones among them, for which libjpeg would make up data.
static void hear_jpeg(j_common_ptr jpeg, int level)
{
	if (level < 0)
		leave_jpeg(jpeg);
}

static void count_scans(j_common_ptr jpeg)
{
	jpeg_source *s = jpeg->client_data;
	if (s->jpeg.input_scan_number <= JPEG_SCANS_MAX)
		return;
	ob_fail(s->e, "a picture of it is a JPEG of more than %d scans", JPEG_SCANS_MAX);
	longjmp(s->left_at, 1);
}

static bool decode_jpeg(jpeg_source *s, ob_mesh_image *out, const unsigned char *bytes, size_t size, size_t most)
{
	if (setjmp(s->left_at))
		return false;
	jpeg_create_decompress(&s->jpeg);
	s->jpeg.progress = &s->progress;
	jpeg_mem_src(&s->jpeg, bytes, size);
	jpeg_read_header(&s->jpeg, TRUE);
	if (!make_room(out, s->jpeg.image_width, s->jpeg.image_height, most, s->e))
		return false;
	s->jpeg.out_color_space = JCS_EXT_RGBA;
	jpeg_start_decompress(&s->jpeg);
	while (s->jpeg.output_scanline < s->jpeg.output_height) {
		JSAMPROW row = out->rgba + 4 * (size_t)out->width * s->jpeg.output_scanline;
		jpeg_read_scanlines(&s->jpeg, &row, 1);
	}
	jpeg_finish_decompress(&s->jpeg);
	return true;
}

static bool read_jpeg(ob_mesh_image *out, const unsigned char *bytes, size_t size, size_t most, ob_error *e)
{
	jpeg_source s = { .e = e };
	s.jpeg.err = jpeg_std_error(&s.errors);
	s.jpeg.client_data = &s;
	s.errors.error_exit = leave_jpeg;
	s.errors.emit_message = hear_jpeg;
	s.progress.progress_monitor = count_scans;
	const bool good = decode_jpeg(&s, out, bytes, size, most);
	jpeg_destroy_decompress(&s.jpeg);
	return good;
}

bool ob_image_read(ob_mesh_image *out, const unsigned char *bytes, size_t size, size_t most, ob_error *e)
{
	bool good = false;
	*out = (ob_mesh_image){ 0 };
	if (size >= 8 && memcmp(bytes, "\x89PNG\r\n\x1a\n", 8) == 0)
		good = read_png(out, bytes, size, most, e);
	else if (size >= 3 && memcmp(bytes, "\xff\xd8\xff", 3) == 0)
		good = read_jpeg(out, bytes, size, most, e);
	else
		ob_fail(e, "a picture of it is neither PNG nor JPEG");
	if (!good) {
		free(out->rgba);
		*out = (ob_mesh_image){ 0 };
	}
	return good;
}
