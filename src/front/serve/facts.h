// JSON messages for viewers: about the universe, its statistics, and one object. Each function makes a message, which
// the caller releases; NULL: out of memory. The server's thread.
#ifndef OB_SERVE_FACTS_H
#define OB_SERVE_FACTS_H

#include "serve/content.h"
#include "serve/message.h"
#include "serve/serve.h"

// {"welcome": title, isolation, arch, sync, role, gravity, look, cameras, params, controls, avatar's name, meshes ..}: the first message. mesh: contents of the
// scene's meshes, by their numbers, less 1; NULL: they are sent otherwise.
ob_message *ob_facts_welcome(const ob_server_config *c, ob_role role, const ob_universe_info *info, bool free_run,
			     const ob_content *mesh);
// {"statistics": objects, awake, pairs, islands, step, viewers, deaths, ended, the hash of a state that stands ("": it does not),
// cpu (s, of all workers), energy (J), penetration (m, the deepest) ..}. energy: someone looks at the last two; else they are null.
ob_message *ob_facts_statistics(const ob_host *h, uint32_t viewers, bool energy, bool paused);
// {"notice": text}
ob_message *ob_facts_notice(const char *text);
// {"avatar": {id, generation}}
ob_message *ob_facts_avatar(uint32_t id, uint32_t generation);
// {"workers": [[pid, rank, objects of the last step, CPU (s), object that it is busy with, or null, s since it died last, or null], ..]}
ob_message *ob_facts_workers(ob_host *h);
// Newest picture of a camera on an object, at most 320 pixels across, as a file of BMP. NULL: there is none.
ob_message *ob_facts_picture(const ob_universe *u, uint32_t sensor);
// The universe's figures in the text format of Prometheus (version 0.0.4), of less than 4 kB
ob_message *ob_facts_metrics(ob_host *h, uint32_t viewers);
// {"notice": the latest failure after *since (ns) that froze objects, in words}, and sets since; NULL also if there is none
ob_message *ob_facts_frozen(ob_host *h, uint64_t *since);
// {"notice": an object that this viewer has created was frozen, and why}. more: further ones. NULL: none, or no memory.
ob_message *ob_facts_own_frozen(ob_host *h, uint32_t id, uint32_t more);
// {"details": name, state, mass, island, worker ..}, or that the object is gone
ob_message *ob_facts_details(const ob_scene *scene, const ob_host *h, uint32_t id);

#endif
