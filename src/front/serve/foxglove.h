// Foxglove's live protocol, version 1 (https://github.com/foxglove/ws-protocol), over the server's WebSockets: a viewer of
// Foxglove subscribes to channels of record/foxglove.h, and is sent what is new on them.
//
//   server                                                 viewer
//     serverInfo, advertise (JSON)        ------------->
//                                         <-------------   subscribe, unsubscribe, getParameters, setParameters (JSON)
//     u8 1, u32 subscription, u64 ns, message  -------->   while its queue is empty: a slow viewer gets less
//     u8 2, u64 ns: the simulated time    ------------->
//
// Parameters are the scene's. An operator may set them, which begins the run anew. The server's thread only.
#ifndef OB_SERVE_FOXGLOVE_H
#define OB_SERVE_FOXGLOVE_H

#include "scene/scene.h"
#include "serve/client.h"

#define OB_FOXGLOVE_PROTOCOL "foxglove.websocket.v1"
#define OB_FOXGLOVE_SDK_PROTOCOL "foxglove.sdk.v1" // the same messages: the name that Foxglove's own servers have since

typedef struct ob_foxglove ob_foxglove;

// The scene must outlive it. send queues a message for the client, and releases it. NULL: out of memory.
ob_foxglove *ob_foxglove_create(const ob_scene *scene, const char *version, ob_client *c,
				void (*send)(ob_client *c, ob_message *m));
void ob_foxglove_destroy(ob_foxglove *f); // NULL is allowed
// Reads a part of a message; sets `request` and returns true if it makes one of them, to be carried out, at a time. Call it with
// size 0 until it returns false.
bool ob_foxglove_read(ob_foxglove *f, const char *bytes, size_t size, bool begins, bool ends, ob_request *request);
// Sends the client a warning.
void ob_foxglove_complain(ob_foxglove *f, const char *what);
// Sends what is new on the channels to which the client has subscribed.
void ob_foxglove_look(ob_foxglove *f, const ob_universe *u);

#endif
