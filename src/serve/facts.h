// What viewers are told in words, as JSON: what universe this is, how it fares, and all about one object. Each makes a
// message that the caller lets go; NULL: out of memory. The server's thread.
#ifndef OB_SERVE_FACTS_H
#define OB_SERVE_FACTS_H

#include "serve/content.h"
#include "serve/message.h"
#include "serve/serve.h"

// {"welcome": title, isolation, gravity, how it looks, cameras, paths of meshes ..}: first of all. mesh: where the scene's
// are, by their numbers, less 1; NULL: they come otherwise.
ob_message *ob_facts_welcome(const ob_server_config *c, const ob_universe_info *info, const ob_content *mesh);
// {"statistics": objects, awake, pairs, islands, step, viewers}
ob_message *ob_facts_statistics(const ob_host *h, uint32_t viewers);
// {"details": name, state, mass, island, worker ..}, or that it is gone
ob_message *ob_facts_details(const ob_scene *scene, const ob_host *h, uint32_t id);

#endif
