#include <arpa/inet.h>
#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#include "base/clock.h"
#include "base/hash.h"
#include "base/interrupt.h"
#include "host/joining.h"
#include "serve/client.h"
#include "serve/door.h"
#include "serve/facts.h"
#include "serve/feed.h"
#include "serve/film.h"
#include "serve/foxglove.h"
#include "serve/http.h"
#include "serve/part.h"
#include "table/free.h"

static const double interval = 1. / 60; // s, between two reads of the universe
static const double share = .3; // limit of their share of the time
static const double detail_interval = .25; // s, between two statistics, and details of inspected objects
static const double commands_rate = 200, creations_rate = 40; // 1/s, per client
enum { CREATIONS_AWAITED = 8 }; // of a client: a step that takes long finds no more of them when it ends
static const char film_path[] = "/recording", meshes_path[] = "/meshes/";
static const char player_path[] = "/player.html"; // a page for the record that a viewer makes
static const char metrics_path[] = "/metrics", pictures_path[] = "/pictures/";
static const char comparison_path[] = "/compare.html"; // the page of several worlds
static const double door_interval = .25; // s, between two checks of deadlines
static const struct timespec idle_wait = { .tv_nsec = 1000000 };
enum {
	SEND_BUFFER = 1 << 18, // bytes: the kernel's buffer for a client; in a larger one, messages would grow old
	PLACES_MAX = 512, // connections other than viewers
	OTHER_FILES = 128, // open files of the program beside its connections
};

// Storage of a content of this server's own
typedef struct own_content {
	ob_message *bytes; // a film's bytes belong to its caller
	char path[40], tag[24];
} own_content;

// A universe, and the viewers that look at it
typedef struct world {
	ob_host *host;
	ob_feed *feed;
	ob_client *clients, *foxgloves; // foxgloves: viewers of Foxglove
	uint64_t frozen_sent; // ns: time of the latest failure that viewers were sent
} world;

struct ob_server {
	ob_server_base base;
	ob_server_config config;
	ob_pace *pace;
	char token[OB_ROLES][33], url[OB_ROLES][160]; // of each role; "" = none
	int port; // the actual port
	own_content *own_bytes; // storage of own
	// a film's page and the film itself; else the scene's meshes, and an empty page for a film. Ends with one
	// without a path
	ob_content *own;

	pthread_t thread;
	bool held; // the thread has ended
	pthread_mutex_t lock; // guards the next three
	bool ending;
	ob_message *told; // for all viewers; NULL: none

	struct lws_context *context; // this and all below: the thread's own
	lws_sorted_usec_list_t tick, door_tick;
	ob_door door;
	world world[OB_SERVER_WORLDS];
	uint32_t worlds; // 0: for a film
	uint32_t count, numbers; // numbers: given to clients so far
	double details_at; // s
	bool anew; // viewers do not know yet that another run has begun
	bool called; // the library has called back in this turn of the loop
};

// The library's data for a connection: half of it for pages, half for a viewer
typedef struct session {
	ob_http_answer answer;
	ob_client client;
} session;

static world *world_of(ob_server *s, const ob_client *c)
{
	return &s->world[c->world];
}

static bool is_foxglove(struct lws *wsi)
{
	const char *name = lws_get_protocol(wsi)->name;
	return strcmp(name, OB_FOXGLOVE_PROTOCOL) == 0 || strcmp(name, OB_FOXGLOVE_SDK_PROTOCOL) == 0;
}

// ---- sending

static void send_to(ob_client *c, ob_message *m)
{
	if (c->queue.count == 0)
		c->taken_at = ob_clock_wall();
	if (!c->behind && !ob_client_queue_put(&c->queue, m))
		c->behind = true;
	lws_callback_on_writable(c->wsi);
}

// Sends a message to all that look at a world, and releases it.
static void send_all(const world *w, ob_message *m, bool contacts)
{
	for (ob_client *c = m ? w->clients : NULL; c; c = c->next) {
		if (!contacts || c->contacts)
			send_to(c, m);
	}
	ob_message_release(m);
}

// Sends joints to those who have asked.
static void send_joints(const world *w)
{
	ob_message *joints = NULL;
	for (ob_client *c = w->clients; c; c = c->next) {
		joints = c->joints && !joints ? ob_feed_joints(w->feed) : joints;
		if (c->joints && joints)
			send_to(c, joints);
	}
	ob_message_release(joints);
}

// Sends who simulates each object, and what workers do, to those who have asked.
static void send_simulators(const world *w)
{
	ob_message *simulators = NULL, *workers = NULL;
	for (ob_client *c = w->clients; c; c = c->next) {
		if (!c->simulators)
			continue;
		simulators = simulators ? simulators : ob_feed_simulators(w->feed);
		workers = workers ? workers : ob_facts_workers(w->host);
		if (!simulators || !workers)
			break;
		send_to(c, simulators);
		send_to(c, workers);
	}
	ob_message_release(simulators);
	ob_message_release(workers);
}

static void send_one(ob_client *c, ob_message *m)
{
	if (m && !m->failed)
		send_to(c, m);
	ob_message_release(m);
}

static void send_error(ob_client *c, const char *text)
{
	ob_message *m = ob_message_new(true);
	if (!m)
		return;
	ob_message_print(m, "{\"error\":");
	ob_message_put_json(m, text);
	ob_message_print(m, "}");
	send_one(c, m);
}

// Notifies viewers of frozen objects: all of the cause, and the creators of theirs.
static void send_frozen(world *w)
{
	size_t at = 0;
	uint32_t id;
	ob_roster_entry entry;
	send_all(w, ob_facts_frozen(w->host, &w->frozen_sent), false);
	while (ob_feed_take_frozen(w->feed, &at, &id)) {
		if (!ob_roster_find(ob_host_roster(w->host), id, &entry) || entry.origin == 0)
			continue;
		for (ob_client *c = w->clients; c; c = c->next) {
			if (c->number == entry.origin && c->frozen++ == 0)
				c->first_frozen = id;
		}
	}
	for (ob_client *c = w->clients; c; c = c->next) {
		if (c->frozen > 0)
			send_one(c, ob_facts_own_frozen(w->host, c->first_frozen, c->frozen - 1));
		c->frozen = 0;
	}
}

static void tell_avatar(ob_client *c)
{
	send_one(c, ob_facts_avatar(c->avatar, c->generation));
}

static void send_all_about(ob_server *s, ob_client *c)
{
	const world *w = world_of(s, c);
	ob_pace_state pace = ob_pace_get(s->pace);
	ob_universe_info info;
	ob_universe_get_info(ob_host_universe(w->host), &info);
	send_one(c,
		 ob_facts_welcome(&s->config, c->role, &info, ob_free_settings_of(ob_host_universe(w->host)), s->own));
	send_one(c, ob_feed_whole(w->feed, &pace));
	send_one(c, ob_facts_statistics(w->host, s->count, c->energy, pace.paused));
	ob_avatar_ask(w->host, s->config.scene, c);
}

// Sends news of the host's thread: another run, and its message.
static void send_news(ob_server *s)
{
	pthread_mutex_lock(&s->lock);
	ob_message *told = s->told;
	s->told = NULL;
	pthread_mutex_unlock(&s->lock);
	for (uint32_t i = 0; told && i < s->worlds; i++) {
		ob_message_hold(told);
		send_all(&s->world[i], told, false);
	}
	ob_message_release(told);
	for (uint32_t i = 0; s->anew && i < s->worlds; i++) {
		for (ob_client *c = s->world[i].foxgloves; c; c = c->next) { // its channels may be others now
			ob_foxglove_destroy(c->foxglove);
			c->foxglove = NULL;
			lws_set_timeout(c->wsi, PENDING_TIMEOUT_KILLED_BY_PARENT, LWS_TO_KILL_ASYNC);
		}
		for (ob_client *c = s->world[i].clients; c; c = c->next) {
			c->avatar = c->inspected = UINT32_MAX;
			send_all_about(s, c);
		}
	}
	s->anew = false;
}

// Sends what need not be new in each frame.
static void send_details(ob_server *s, world *w, bool paused)
{
	bool energy = false;
	ob_avatars_update(w->host, s->config.scene, w->clients, tell_avatar);
	if (!w->clients)
		return;
	for (ob_client *c = w->clients; c; c = c->next)
		energy |= c->energy;
	send_frozen(w);
	send_joints(w);
	send_simulators(w);
	send_all(w, ob_facts_statistics(w->host, s->count, energy, paused), false);
}

static void drop_stuck(ob_client *c, double now)
{
	if (c->queue.count == 0)
		c->taken_at = now;
	else if (now - c->taken_at > OB_SERVER_STUCK)
		lws_set_timeout(c->wsi, PENDING_TIMEOUT_KILLED_BY_PARENT, LWS_TO_KILL_ASYNC);
}

static void look_at(ob_server *s, world *w, double now, bool details)
{
	const ob_pace_state pace = ob_pace_get(s->pace);
	bool contacts = false;
	if (w->clients)
		send_all(w, ob_feed_next(w->feed, &pace), false);
	for (ob_client *c = w->foxgloves; c; c = c->next) {
		drop_stuck(c, now);
		if (c->foxglove)
			ob_foxglove_look(c->foxglove, ob_host_universe(w->host));
	}
	for (ob_client *c = w->clients; c; c = c->next) {
		contacts |= c->contacts;
		drop_stuck(c, now);
		if (details && c->inspected != UINT32_MAX)
			send_one(c, ob_facts_details(s->config.scene, w->host, c->inspected));
	}
	if (contacts)
		send_all(w, ob_feed_contacts(w->feed), true);
	if (details)
		send_details(s, w, pace.paused);
}

static void look(lws_sorted_usec_list_t *tick)
{
	ob_server *s = lws_container_of(tick, ob_server, tick);
	const double begin = ob_clock_wall();
	const bool details = begin >= s->details_at;
	s->called = true;
	send_news(s);
	for (uint32_t i = 0; i < s->worlds; i++)
		look_at(s, &s->world[i], begin, details);
	if (details)
		s->details_at = begin + detail_interval;
	double wait = fmax(interval, (ob_clock_wall() - begin) / share);
	lws_sul_schedule(s->context, 0, &s->tick, look, (lws_usec_t)(1e6 * wait));
}

// ---- receiving

// True if the visitor may create one more object now.
static bool may_create(const ob_host *h, ob_client *c)
{
	const uint64_t roster = ob_roster_number(ob_host_roster(h));
	if (c->roster != roster)
		c->roster = roster, c->awaited = 0;
	if (!ob_allowance_take(&c->creations, ob_clock_wall(), creations_rate))
		send_error(c, "too many objects in a second: try again");
	else if (ob_roster_copy(ob_host_roster(h), NULL, 0) >= ob_universe_capacity(ob_host_universe(h)))
		send_error(c, "the universe is full: remove an object first");
	else if (c->awaited == CREATIONS_AWAITED)
		send_error(c, "your last objects have not come yet: try again");
	else
		return ++c->awaited;
	return false;
}

// Carries out a request to see more, or less.
static void look_as_asked(ob_server *s, ob_client *c, const ob_request *r)
{
	switch (r->kind) {
	case OB_LOOK_CONTACTS:
		c->contacts = r->on;
		return;
	case OB_LOOK_JOINTS:
		c->joints = r->on;
		return;
	case OB_LOOK_SIMULATORS:
		c->simulators = r->on;
		return;
	case OB_LOOK_ENERGY:
		c->energy = r->on;
		return;
	case OB_LOOK_ANEW:
		c->behind = true;
		lws_callback_on_writable(c->wsi);
		return;
	default:
		c->inspected = r->id;
		if (r->id != UINT32_MAX)
			send_one(c, ob_facts_details(s->config.scene, world_of(s, c)->host, r->id));
	}
}

static void carry_out(ob_server *s, ob_client *c, ob_command *asked)
{
	ob_host *h = world_of(s, c)->host;
	for (uint32_t i = 0; i < asked->requests; i++) {
		ob_request *r = &asked->request[i];
		ob_error e;
		if (r->kind >= OB_REQUEST_KINDS) {
			look_as_asked(s, c, r);
			return;
		}
		if (ob_is_joint_request(r) &&
		    !ob_joint_request_find(ob_host_universe(h), (const char *)r->values, r, &e)) {
			send_error(c, e.text);
			return;
		}
		r->origin = c->number;
		c->pulls |= r->kind == OB_REQUEST_PUSH || r->kind == OB_REQUEST_DRAG || r->kind == OB_REQUEST_TORQUE;
		if (r->kind == OB_REQUEST_ADD && c->role >= OB_ROLE_TAKE_PART && !may_create(h, c))
			continue;
		if (!ob_host_ask_as(h, c->role, r, &e))
			send_error(c, e.text);
	}
}

static int refuse_client(ob_client *c, enum lws_close_status status, const char *why)
{
	unsigned char text[124];
	size_t n = strnlen(why, sizeof text - 1);
	memcpy(text, why, n);
	lws_close_reason(c->wsi, status, text, n);
	return -1;
}

// Reads a part of a message of a viewer of Foxglove.
static int receive_foxglove(ob_server *s, ob_client *c, const char *bytes, size_t size)
{
	const bool begins = lws_is_first_fragment(c->wsi) && c->command_size == 0,
		   ends = lws_is_final_fragment(c->wsi) && lws_remaining_packet_payload(c->wsi) == 0;
	ob_request r;
	ob_error e;
	if (!c->foxglove || lws_frame_is_binary(c->wsi))
		return refuse_client(c, LWS_CLOSE_STATUS_UNACCEPTABLE_OPCODE, "messages are text");
	if (begins && !ob_allowance_take(&c->commands, ob_clock_wall(), commands_rate))
		return refuse_client(c, LWS_CLOSE_STATUS_POLICY_VIOLATION, "too many messages in a second");
	c->command_size = ends ? 0 : 1;
	for (bool more = ob_foxglove_read(c->foxglove, bytes, size, begins, ends, &r); more;
	     more = ob_foxglove_read(c->foxglove, NULL, 0, false, false, &r)) {
		r.origin = c->number;
		if (!ob_host_ask_as(world_of(s, c)->host, c->role, &r, &e))
			ob_foxglove_complain(c->foxglove, e.text);
	}
	return 0;
}

static int receive(ob_server *s, ob_client *c, const char *bytes, size_t size)
{
	ob_command asked;
	ob_error e;
	if (lws_frame_is_binary(c->wsi))
		return refuse_client(c, LWS_CLOSE_STATUS_UNACCEPTABLE_OPCODE, "commands are text");
	if (c->command_size + size > OB_COMMAND_BYTES_MAX)
		return refuse_client(c, LWS_CLOSE_STATUS_MESSAGE_TOO_LARGE, "commands are short");
	memcpy(c->command + c->command_size, bytes, size);
	c->command_size += size;
	if (!lws_is_final_fragment(c->wsi) || lws_remaining_packet_payload(c->wsi) > 0)
		return 0;
	size = c->command_size;
	c->command_size = 0;
	if (!ob_allowance_take(&c->commands, ob_clock_wall(), commands_rate))
		return refuse_client(c, LWS_CLOSE_STATUS_POLICY_VIOLATION, "too many commands in a second");
	c->command[size] = 0;
	if (ob_command_read(&asked, c->command, size, &e))
		carry_out(s, c, &asked);
	else
		send_error(c, e.text);
	return 0;
}

// ---- connections

static bool is_token(const char *token, const char *value)
{
	unsigned differ = 0;
	if (!*token || strlen(value) != strlen(token))
		return false;
	for (size_t i = 0; token[i]; i++) // takes constant time, wherever they differ
		differ |= (unsigned)(token[i] ^ value[i]);
	return differ == 0;
}

// Finds the role of the visitor's token. false: it has none.
static bool find_role(const ob_server *s, struct lws *wsi, ob_role *role)
{
	char text[64];
	const char *value = lws_get_urlarg_by_name(wsi, "token=", text, sizeof text);
	bool found = false;
	*role = OB_ROLE_WATCH;
	for (ob_role r = OB_ROLE_WATCH; value && r < OB_ROLES; r++) {
		if (!is_token(s->token[r], value))
			continue;
		*role = r;
		found = true;
	}
	return found;
}

static bool has_token(const ob_server *s, struct lws *wsi)
{
	ob_role role;
	return s->config.listen.loopback || find_role(s, wsi, &role);
}

static ob_role role_of(const ob_server *s, struct lws *wsi)
{
	ob_role role = OB_ROLE_WATCH;
	if (s->config.look_only)
		return role;
	if (s->config.listen.loopback)
		return ob_peer_is_ours(lws_get_socket_fd(wsi)) ? OB_ROLE_OPERATE : OB_ROLE_TAKE_PART;
	find_role(s, wsi, &role);
	return role;
}

// Number of the world that a visitor asks for, 0 by default; none: UINT32_MAX.
static uint32_t asked_world(const ob_server *s, struct lws *wsi)
{
	char text[16];
	const char *value = lws_get_urlarg_by_name(wsi, "world=", text, sizeof text);
	for (uint32_t i = 0; i < s->worlds; i++)
		if (!value || (value[0] == (char)('0' + i) && !value[1]))
			return i;
	return UINT32_MAX;
}

// Before the answer to the handshake. Other than 0: refused, with an answer.
static int let_in(const ob_server *s, struct lws *wsi)
{
	const char *why = NULL;
	unsigned status = HTTP_STATUS_FORBIDDEN;
	const bool foxglove = is_foxglove(wsi);
	if (foxglove && !s->config.foxglove) {
		why = "viewers of Foxglove are let in by obsim serve --foxglove";
	} else if (!ob_http_is_ours(wsi, s->config.listen.address, s->port, !s->config.listen.loopback, foxglove)) {
		why = "only pages of this server may connect to this universe";
	} else if (!has_token(s, wsi)) {
		why = "the token is missing or wrong: use the address that obsim serve has printed";
	} else if (s->count >= s->config.viewers) {
		why = "there are as many viewers as this server lets in (--viewers)";
		status = HTTP_STATUS_SERVICE_UNAVAILABLE;
	}
	if (!why && s->config.film)
		why = "a recording is shown here, which a page plays by itself";
	else if (!why && asked_world(s, wsi) == UINT32_MAX)
		why = "there is no world of this number here";
	if (why)
		lws_return_http_status(wsi, status, why);
	return why != NULL;
}

static bool is_below(const char *path, const char *folder)
{
	return strncmp(path, folder, strlen(folder)) == 0;
}

static int answer_message(struct lws *wsi, const char *type, ob_message *m)
{
	const int result = m && !m->failed ? ob_http_answer_whole(wsi, type, m->bytes, m->size) : -1;
	ob_message_release(m);
	return result;
}

static int answer(const ob_server *s, struct lws *wsi, ob_http_answer *a, const char *path)
{
	const char *why = NULL;
	ob_door_move(wsi, OB_AT_ANSWER, ob_clock_wall());
	lws_set_timeout(wsi, NO_PENDING_TIMEOUT, 0); // else the library ends a long answer, at any speed
	if (!ob_http_is_ours(wsi, s->config.listen.address, s->port, !s->config.listen.loopback, false))
		why = "this is not the name of this server";
	else if ((strcmp(path, film_path) == 0 || strcmp(path, metrics_path) == 0 || is_below(path, meshes_path) ||
		  is_below(path, pictures_path)) &&
		 !has_token(s, wsi))
		why = "the token is missing or wrong: use the address that obsim serve has printed";
	if (!why && s->worlds == 1 && strcmp(path, metrics_path) == 0)
		return answer_message(wsi, "text/plain; charset=utf-8", ob_facts_metrics(s->world->host, s->count));
	ob_message *picture = why || !s->worlds || !is_below(path, pictures_path)
				      ? NULL
				      : ob_facts_picture(ob_host_universe(s->world->host),
							 (uint32_t)strtoul(path + strlen(pictures_path), NULL, 10));
	if (picture)
		return answer_message(wsi, "image/bmp", picture);
	if (!why)
		return ob_http_answer_request(wsi, a, s->worlds > 1 && strcmp(path, "/") == 0 ? comparison_path : path,
					      s->own);
	lws_return_http_status(wsi, HTTP_STATUS_FORBIDDEN, why);
	return -1;
}

// Accepts an upgrade to WebSocket, and to no other protocol of the library. Other than 0: it is closed.
static int confirm_upgrade(struct lws *wsi)
{
	char to[16];
	// the header is missing where the library itself has refused; such connections are closed, too
	const int size = lws_hdr_copy(wsi, to, sizeof to, WSI_TOKEN_UPGRADE);
	if (size > 0 && strcasecmp(to, "websocket") == 0)
		return 0;
	if (size > 0)
		lws_return_http_status(wsi, HTTP_STATUS_FORBIDDEN, "a connection can be upgraded to websocket only");
	return -1;
}

static void look_at_door(lws_sorted_usec_list_t *tick)
{
	ob_server *s = lws_container_of(tick, ob_server, door_tick);
	s->called = true;
	ob_door_look(&s->door, ob_clock_wall());
	lws_sul_schedule(s->context, 0, &s->door_tick, look_at_door, (lws_usec_t)(1e6 * door_interval));
}

// Other than 0: it is closed.
static int enter(ob_server *s, ob_client *c, struct lws *wsi)
{
	int bytes = SEND_BUFFER;
	double now = ob_clock_wall();
	*c = (ob_client){ .wsi = wsi,
			  .role = role_of(s, wsi),
			  .world = asked_world(s, wsi),
			  .taken_at = now,
			  .inspected = UINT32_MAX,
			  .avatar = UINT32_MAX,
			  .number = ++s->numbers,
			  .commands = { commands_rate, now },
			  .creations = { creations_rate, now } };
	const bool foxglove = is_foxglove(wsi);
	ob_client **list = foxglove ? &world_of(s, c)->foxgloves : &world_of(s, c)->clients;
	c->next = *list;
	*list = c;
	s->count++;
	ob_door_move(wsi, OB_AT_VIEWER, now);
	setsockopt(lws_get_socket_fd(wsi), SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
	if (!foxglove) {
		send_all_about(s, c);
		return 0;
	}
	c->role = ob_http_is_page(wsi) ? OB_ROLE_WATCH : c->role;
	c->foxglove = ob_foxglove_create(s->config.scene, s->config.version, c, send_one);
	return c->foxglove ? 0 : -1;
}

static bool take_out(ob_client **list, const ob_client *c)
{
	while (*list && *list != c)
		list = &(*list)->next;
	if (!*list)
		return false;
	*list = c->next;
	return true;
}

static void leave(ob_server *s, ob_client *c)
{
	world *w = world_of(s, c);
	ob_foxglove_destroy(c->foxglove);
	s->count -= take_out(&w->clients, c) || take_out(&w->foxgloves, c); // one that was refused is in neither
	ob_client_queue_clear(&c->queue);
	ob_error e;
	ob_request lets_go = { .kind = OB_REQUEST_RELEASE, .id = UINT32_MAX, .origin = c->number };
	if (c->pulls)
		ob_host_ask(world_of(s, c)->host, &lets_go, &e);
}

static int write_some(ob_server *s, ob_client *c)
{
	unsigned before = c->queue.count;
	size_t sent = c->queue.sent;
	if (!ob_client_write(c))
		return -1;
	if (c->queue.count != before || c->queue.sent != sent)
		c->taken_at = ob_clock_wall();
	if (c->behind && c->queue.count == 0 && !is_foxglove(c->wsi)) {
		ob_pace_state pace = ob_pace_get(s->pace);
		c->behind = false;
		send_one(c, ob_feed_whole(world_of(s, c)->feed, &pace));
	}
	return 0;
}

static bool is_ending(ob_server *s)
{
	pthread_mutex_lock(&s->lock);
	bool ending = s->ending;
	pthread_mutex_unlock(&s->lock);
	return ending;
}

static int on_event(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in, size_t size)
{
	ob_server *s = lws_context_user(lws_get_context(wsi));
	session *now = user;
	s->called = true;
	switch (reason) {
	case LWS_CALLBACK_SERVER_NEW_CLIENT_INSTANTIATED:
		return !ob_door_enter(&s->door, wsi, ob_clock_wall());
	case LWS_CALLBACK_WSI_DESTROY:
		ob_door_leave(&s->door, wsi);
		return 0;
	case LWS_CALLBACK_RAW_ADOPT: // after CONNECT, from which on the library parses nothing
		return -1;
	case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
		return confirm_upgrade(wsi);
	case LWS_CALLBACK_HTTP:
		return answer(s, wsi, &now->answer, in);
	case LWS_CALLBACK_HTTP_WRITEABLE:
		return ob_http_go_on(wsi, &now->answer);
	case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION:
		return let_in(s, wsi);
	case LWS_CALLBACK_ESTABLISHED:
		return enter(s, &now->client, wsi);
	case LWS_CALLBACK_RECEIVE:
		return is_foxglove(wsi) ? receive_foxglove(s, &now->client, in, size)
					: receive(s, &now->client, in, size);
	case LWS_CALLBACK_SERVER_WRITEABLE:
		return write_some(s, &now->client);
	case LWS_CALLBACK_CLOSED:
		leave(s, &now->client);
		return 0;
	default:
		return lws_callback_http_dummy(wsi, reason, user, in, size);
	}
}

// ---- start and end

static const struct lws_protocols protocols[] = {
	{ .name = "obsim",
	  .callback = on_event,
	  .per_session_data_size = sizeof(session),
	  .rx_buffer_size = OB_COMMAND_BYTES_MAX },
	{ .name = OB_FOXGLOVE_PROTOCOL,
	  .callback = on_event,
	  .per_session_data_size = sizeof(session),
	  .rx_buffer_size = OB_COMMAND_BYTES_MAX },
	{ .name = OB_FOXGLOVE_SDK_PROTOCOL,
	  .callback = on_event,
	  .per_session_data_size = sizeof(session),
	  .rx_buffer_size = OB_COMMAND_BYTES_MAX },
	{ .name = NULL },
};
static const lws_retry_bo_t patience = { .secs_since_valid_ping = 20, .secs_since_valid_hangup = 40 };

static void *serve(void *argument)
{
	ob_server *s = argument;
	pthread_setname_np(pthread_self(), "server");
	while (!is_ending(s) && lws_service(s->context, 0) >= 0) {
		// The library polls without waiting while a connection has sent more than may be read before its answer
		// ends, and in the last millisecond before a timer. Such a turn does nothing.
		if (!s->called)
			nanosleep(&idle_wait, NULL);
		s->called = false;
	}
	return NULL;
}

// The library's last message while a server starts
static __thread char complaint[200];

static void note_complaint(int level, const char *line)
{
	const char *text = strstr(line, ": ");
	(void)level;
	snprintf(complaint, sizeof complaint, "%s", text ? text + 2 : line);
	complaint[strcspn(complaint, "\n")] = 0;
}

// The most that a visitor may do.
static ob_role most_of(const ob_server *s)
{
	return s->config.look_only ? OB_ROLE_WATCH : OB_ROLE_OPERATE;
}

static bool make_tokens(ob_server *s, ob_error *e)
{
	unsigned char random[16];
	for (ob_role r = OB_ROLE_WATCH; !s->config.listen.loopback && r <= most_of(s); r++) {
		if (getrandom(random, sizeof random, 0) != sizeof random)
			return ob_fail(e, "no random numbers for a token: %s", strerror(errno));
		for (size_t i = 0; i < sizeof random; i++)
			snprintf(s->token[r] + 2 * i, 3, "%02x", random[i]);
	}
	return true;
}

// Checks the address before the library does, whose errors explain less, and which leaks.
static bool is_free(const ob_listen *l, ob_error *e)
{
	struct sockaddr_in four = { .sin_family = AF_INET, .sin_port = htons((uint16_t)l->port) };
	struct sockaddr_in6 six = { .sin6_family = AF_INET6, .sin6_port = htons((uint16_t)l->port) };
	inet_pton(AF_INET, l->address, &four.sin_addr);
	inet_pton(AF_INET6, l->address, &six.sin6_addr);
	int fd = socket(l->six ? AF_INET6 : AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0), one = 1;
	bool bound = fd >= 0 && setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one) == 0 &&
		     bind(fd, l->six ? (struct sockaddr *)&six : (struct sockaddr *)&four,
			  l->six ? sizeof six : sizeof four) == 0;
	int error = errno;
	if (fd >= 0)
		close(fd);
	return bound ||
	       ob_fail(e, "--listen %s:%d: %s (port 0 is one that is free)", l->address, l->port, strerror(error));
}

// Ensures that the process may open as many files as there are places, and some more.
static bool may_open(uint32_t connections, uint32_t viewers, ob_error *e)
{
	struct rlimit r;
	const rlim_t needed = connections + OTHER_FILES;
	if (getrlimit(RLIMIT_NOFILE, &r) != 0 || r.rlim_cur >= needed)
		return true;
	r.rlim_cur = needed < r.rlim_max ? needed : r.rlim_max;
	return (r.rlim_cur == needed && setrlimit(RLIMIT_NOFILE, &r) == 0) ||
	       ob_fail(e, "--viewers %u: they need %u open files, and this process may have %u: raise ulimit -n",
		       viewers, (unsigned)needed, (unsigned)r.rlim_max);
}

static bool open_context(ob_server *s, ob_error *e)
{
	const ob_listen *listen = &s->config.listen;
	const uint32_t viewers = s->config.viewers, places = 64 + 2 * viewers;
	s->door.places = places < PLACES_MAX ? places : PLACES_MAX;
	s->door.share = s->door.places / 2;
	// more than the places: a replaced connection is closed a moment later
	const uint32_t connections = viewers + 2 * s->door.places;
	if (!is_free(listen, e) || !may_open(connections, viewers, e))
		return false;
	lws_set_log_level(LLL_ERR | LLL_WARN, note_complaint);
	struct lws_context_creation_info info = {
		.port = listen->port,
		.iface = s->config.listen.address,
		.protocols = protocols,
		.user = s,
		.gid = (gid_t)-1,
		.uid = (uid_t)-1,
		.options = LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND | LWS_SERVER_OPTION_DISABLE_OS_CA_CERTS |
			   (listen->six ? 0 : LWS_SERVER_OPTION_DISABLE_IPV6),
		.fd_limit_per_thread = connections,
		.max_http_header_pool2 = connections,
		.timeout_secs = OB_DOOR_REQUEST,
		.timeout_secs_ah_idle = OB_DOOR_REQUEST,
		.keepalive_timeout = OB_DOOR_IDLE,
		.retry_and_idle_policy = &patience,
		.vhost_name = "obsim",
	};
	s->context = lws_create_context(&info);
	struct lws_vhost *host = s->context ? lws_get_vhost_by_name(s->context, "obsim") : NULL;
	if (!host)
		return ob_fail(e, "--listen %s:%d: %s", listen->address, listen->port,
			       *complaint ? complaint : "the server cannot listen there");
	s->port = lws_get_vhost_listen_port(host);
	for (ob_role r = OB_ROLE_WATCH; r <= most_of(s); r++)
		if (!listen->loopback || r == most_of(s))
			snprintf(s->url[r], sizeof s->url[r], listen->six ? "http://[%s]:%d/%s%s" : "http://%s:%d/%s%s",
				 listen->address, s->port, listen->loopback ? "" : "#token=", s->token[r]);
	return true;
}

// Entity tag, by which a browser recognises contents that it has.
static uint64_t hash_of(const ob_message *m)
{
	return ob_hash_on(OB_HASH_BEGIN, m->bytes, m->size);
}

// Adds content number i of the server's own; path: NULL: its hash names it. bytes: must last as long as the server.
static void add_own(ob_server *s, uint32_t i, const char *path, const char *type, const ob_message *bytes)
{
	own_content *o = &s->own_bytes[i];
	const unsigned long long hash = hash_of(bytes);
	snprintf(o->tag, sizeof o->tag, "\"%016llx\"", hash);
	if (path)
		snprintf(o->path, sizeof o->path, "%s", path);
	else
		snprintf(o->path, sizeof o->path, "%s%016llx", meshes_path, hash);
	s->own[i] = (ob_content){ o->path, type, o->tag, bytes->bytes, bytes->size, !path };
}

static bool prepare_own(ob_server *s, ob_error *e)
{
	const ob_message *film = s->config.film;
	const ob_scene *scene = s->config.scene;
	const uint32_t count = film ? 2 : scene->meshes + 1;
	s->own_bytes = calloc(count + 1, sizeof *s->own_bytes);
	s->own = calloc(count + 1, sizeof *s->own);
	bool ok = s->own_bytes && s->own;
	if (ok && film) {
		s->own_bytes[0].bytes = ob_film_page_served();
		ok = s->own_bytes[0].bytes;
		if (ok) {
			add_own(s, 0, "/index.html", "text/html; charset=utf-8", s->own_bytes[0].bytes);
			add_own(s, 1, film_path, "application/gzip", film);
		}
	}
	for (uint32_t i = 0; ok && !film && i < scene->meshes; i++) {
		s->own_bytes[i].bytes = ob_feed_mesh(&scene->mesh[i], i + 1);
		ok = s->own_bytes[i].bytes;
		if (ok)
			add_own(s, i, NULL, "application/octet-stream", s->own_bytes[i].bytes);
	}
	if (ok && !film) {
		own_content *player = &s->own_bytes[scene->meshes];
		player->bytes = ob_film_page_whole(NULL);
		ok = player->bytes;
		if (ok)
			add_own(s, scene->meshes, player_path, "text/html; charset=utf-8", player->bytes);
	}
	return ok || ob_fail(e, "out of memory");
}

static void release_own(ob_server *s)
{
	for (uint32_t i = 0; s->own_bytes && s->own && s->own[i].path; i++)
		ob_message_release(s->own_bytes[i].bytes);
	free(s->own_bytes);
	free(s->own);
}

static bool start_thread(ob_server *s, ob_error *e)
{
	sigset_t before;
	ob_interrupt_leave_to_main(&before);
	int failure = pthread_create(&s->thread, NULL, serve, s);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	return failure == 0 || ob_fail(e, "the server's thread cannot be started: %s", strerror(failure));
}

static bool make_feed(world *w)
{
	ob_feed_destroy(w->feed);
	w->feed = ob_feed_create(ob_host_universe(w->host), ob_host_roster(w->host));
	return w->feed;
}

static void free_server(ob_server *s)
{
	if (s->context)
		lws_context_destroy(s->context);
	for (uint32_t i = 0; i < s->worlds; i++)
		ob_feed_destroy(s->world[i].feed);
	ob_message_release(s->told);
	release_own(s);
	pthread_mutex_destroy(&s->lock);
	free(s);
}

static ob_server *start_server(const ob_server_config *c, ob_host *const *h, uint32_t hosts, ob_pace *pace, ob_error *e)
{
	ob_server *s = calloc(1, sizeof *s);
	if (!s) {
		ob_fail(e, "out of memory");
		return NULL;
	}
	s->config = *c;
	s->pace = pace;
	pthread_mutex_init(&s->lock, NULL);
	bool ready = make_tokens(s, e) && prepare_own(s, e) && open_context(s, e);
	for (; ready && s->worlds < hosts; s->worlds++) {
		s->world[s->worlds].host = h[s->worlds];
		ready = make_feed(&s->world[s->worlds]) || ob_fail(e, "out of memory");
	}
	if (ready) {
		if (hosts)
			lws_sul_schedule(s->context, 0, &s->tick, look, 1);
		lws_sul_schedule(s->context, 0, &s->door_tick, look_at_door, 1);
		if (start_thread(s, e))
			return s;
	}
	free_server(s);
	return NULL;
}

static const char *url_of(const ob_server *s, ob_role role)
{
	return role == OB_ROLE_OPERATE ? s->url[most_of(s)] : most_of(s) == OB_ROLE_WATCH ? "" : s->url[role];
}

static void tell(ob_server *s, ob_message *m)
{
	pthread_mutex_lock(&s->lock);
	ob_message_release(s->told);
	s->told = m;
	pthread_mutex_unlock(&s->lock);
}

// Ends the thread; connections stay.
static void hold(ob_server *s)
{
	pthread_mutex_lock(&s->lock);
	s->ending = true;
	pthread_mutex_unlock(&s->lock);
	lws_cancel_service(s->context);
	pthread_join(s->thread, NULL);
	s->held = true;
}

static bool go_on(ob_server *s, const ob_scene *scene, ob_host *const *h, ob_error *e)
{
	bool fed = true;
	for (uint32_t i = 0; i < s->worlds; i++) {
		s->world[i].host = h[i];
		s->world[i].frozen_sent = 0;
		fed = fed && make_feed(&s->world[i]);
	}
	s->config.scene = scene;
	s->anew = true;
	s->ending = false;
	s->held = !fed || !start_thread(s, e);
	return fed ? !s->held : ob_fail(e, "out of memory");
}

static void stop_server(ob_server *s)
{
	if (!s->held)
		hold(s);
	free_server(s);
}

OB_PART(ob_serve_part) = {
	OB_PART_HEAD(ob_serve_part), .start = start_server, .url = url_of, .tell = tell, .hold = hold, .go_on = go_on,
	.stop = stop_server
};
