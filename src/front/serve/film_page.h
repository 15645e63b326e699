// The viewer's page for a film (film.h). Pure; any thread.
#ifndef OB_SERVE_FILM_PAGE_H
#define OB_SERVE_FILM_PAGE_H

#include "serve/message.h"

// The page of a server, which serves scripts, style and shaders, too, and the film as "recording".
ob_message *ob_film_page_served(void);
// The page with all of these in it, without a server. film: NULL: a page into which a viewer puts its own record.
// NULL: out of memory.
ob_message *ob_film_page_whole(const ob_message *film);

#endif
