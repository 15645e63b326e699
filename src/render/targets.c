#include "render/targets.h"

#include "render/frame.h"

static GLuint renderbuffer(GLenum attachment, GLenum format, const ob_targets *t, int samples)
{
	GLuint id;
	glGenRenderbuffers(1, &id);
	glBindRenderbuffer(GL_RENDERBUFFER, id);
	glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, format, t->width, t->height);
	glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, id);
	return id;
}

static GLuint texture(GLenum attachment, GLenum inner, GLenum format, GLenum type, int texels)
{
	GLuint id;
	bool depth = attachment == GL_DEPTH_ATTACHMENT;
	glGenTextures(1, &id);
	glBindTexture(GL_TEXTURE_2D, id);
	glTexImage2D(GL_TEXTURE_2D, 0, (GLint)inner, texels, texels, 0, format, type, NULL);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE); // the maps' margins are empty
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
	if (depth) {
		glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
		glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
	}
	glFramebufferTexture2D(GL_FRAMEBUFFER, attachment, GL_TEXTURE_2D, id, 0);
	return id;
}

static GLuint framebuffer(void)
{
	GLuint id;
	glGenFramebuffers(1, &id);
	glBindFramebuffer(GL_FRAMEBUFFER, id);
	return id;
}

static bool complete(const char *name, ob_error *e)
{
	if (glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE)
		return true;
	return ob_fail(e, "the driver cannot draw into the %s (is there enough graphics memory?)", name);
}

static bool create_maps(ob_targets *t, ob_error *e)
{
	t->sun = framebuffer();
	t->sun_depth =
		texture(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT16, GL_DEPTH_COMPONENT, GL_UNSIGNED_INT, OB_SUN_TEXELS);
	glDrawBuffer(GL_NONE);
	glReadBuffer(GL_NONE);
	if (!complete("shadow map", e))
		return false;
	for (int i = 0; i < 2; i++) {
		t->cover[i] = framebuffer();
		t->cover_texture[i] = texture(GL_COLOR_ATTACHMENT0, GL_R8, GL_RED, GL_UNSIGNED_BYTE, OB_CONTACT_TEXELS);
		if (!complete("contact map", e))
			return false;
	}
	return true;
}

bool ob_targets_create(ob_targets *t, int width, int height, int samples, ob_error *e)
{
	GLint most = 1, widest = 0;
	glGetIntegerv(GL_MAX_SAMPLES, &most);
	glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &widest);
	if (width > widest || height > widest)
		return ob_fail(e, "frames of %dx%d: this driver draws at most %dx%d", width, height, widest, widest);
	*t = (ob_targets){ .width = width, .height = height, .samples = samples < most ? samples : most };
	t->plain = framebuffer();
	t->plain_colour = renderbuffer(GL_COLOR_ATTACHMENT0, GL_RGBA8, t, 0);
	if (t->samples > 1) {
		if (!complete("picture", e))
			return false;
		t->multi = framebuffer();
		t->multi_colour = renderbuffer(GL_COLOR_ATTACHMENT0, GL_RGBA8, t, t->samples);
	}
	t->depth = renderbuffer(GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT24, t, t->samples > 1 ? t->samples : 0);
	return complete("picture", e) && create_maps(t, e);
}

void ob_targets_destroy(ob_targets *t)
{
	const GLuint framebuffers[] = { t->plain, t->multi, t->sun, t->cover[0], t->cover[1] };
	const GLuint renderbuffers[] = { t->plain_colour, t->multi_colour, t->depth };
	const GLuint textures[] = { t->sun_depth, t->cover_texture[0], t->cover_texture[1] };
	glDeleteFramebuffers(5, framebuffers); // zeros are ignored
	glDeleteRenderbuffers(3, renderbuffers);
	glDeleteTextures(3, textures);
}
