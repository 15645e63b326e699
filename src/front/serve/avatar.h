// Avatars: objects that the scene's template (avatar = true) makes for viewers, one for each that may take part. The server's
// thread.
#ifndef OB_SERVE_AVATAR_H
#define OB_SERVE_AVATAR_H

#include "host/host.h"
#include "serve/client.h"

// Requests an avatar for a new viewer, at a free place near the template's. Scenes without avatars: nothing.
void ob_avatar_ask(ob_host *h, const ob_scene *scene, const ob_client *c);
// Finds each viewer's avatar, requests those that are missing, and removes those whose viewer has gone. Calls found for
// viewers whose avatar is another than before.
void ob_avatars_update(ob_host *h, const ob_scene *scene, ob_client *clients, void (*found)(ob_client *c));

#endif
