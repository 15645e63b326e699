// The viewer's page for a film (film.h). Pure; any thread.
#ifndef OB_SERVE_FILM_PAGE_H
#define OB_SERVE_FILM_PAGE_H

#include "serve/message.h"

// As a server hands it out, which hands out scripts, style and shaders, too, and the film as "recording".
ob_message *ob_film_page_served(void);
// With all of these in it, so that it needs nobody. NULL: out of memory.
ob_message *ob_film_page_whole(const ob_message *film);

#endif
