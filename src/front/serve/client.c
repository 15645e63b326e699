#include "serve/client.h"

#include <string.h>

enum { CHUNK = 32768 }; // bytes written at once

static ob_message *first(const ob_client_queue *q)
{
	return q->waiting[q->head % OB_CLIENT_QUEUE];
}

static void drop_last(ob_client_queue *q)
{
	ob_message *m = q->waiting[(q->head + --q->count) % OB_CLIENT_QUEUE];
	q->bytes -= m->size;
	ob_message_release(m);
}

bool ob_client_queue_put(ob_client_queue *q, ob_message *m)
{
	// a message above the limit is accepted into an empty queue
	if (q->count == OB_CLIENT_QUEUE || (q->count > 0 && q->bytes + m->size > OB_CLIENT_BYTES)) {
		while (q->count > (q->sent > 0)) // half a message cannot be taken back
			drop_last(q);
		return false;
	}
	ob_message_hold(m);
	q->waiting[(q->head + q->count++) % OB_CLIENT_QUEUE] = m;
	q->bytes += m->size;
	return true;
}

void ob_client_queue_clear(ob_client_queue *q)
{
	while (q->count > 0)
		drop_last(q);
	q->sent = 0;
}

bool ob_client_write(ob_client *v)
{
	ob_client_queue *q = &v->queue;
	unsigned char buffer[LWS_PRE + CHUNK];
	while (q->count > 0 && !lws_send_pipe_choked(v->wsi)) {
		ob_message *m = first(q);
		size_t n = m->size - q->sent < CHUNK ? m->size - q->sent : CHUNK;
		bool begins = q->sent == 0, ends = q->sent + n == m->size;
		// a copy, for the library writes its own header before the bytes, which other viewers still need
		memcpy(buffer + LWS_PRE, m->bytes + q->sent, n);
		enum lws_write_protocol kind = m->text ? LWS_WRITE_TEXT : LWS_WRITE_BINARY;
		if (lws_write(v->wsi, buffer + LWS_PRE, n,
			      (enum lws_write_protocol)lws_write_ws_flags(kind, begins, ends)) < (int)n)
			return false;
		q->sent += n;
		if (!ends)
			continue;
		q->sent = 0;
		q->head = (q->head + 1) % OB_CLIENT_QUEUE;
		q->count--;
		q->bytes -= m->size;
		ob_message_release(m);
	}
	if (q->count > 0)
		lws_callback_on_writable(v->wsi);
	return true;
}

bool ob_allowance_take(ob_allowance *a, double now, double rate)
{
	a->left += (now - a->at) * rate;
	a->left = a->left < rate ? a->left : rate;
	a->at = now;
	if (a->left < 1)
		return false;
	a->left--;
	return true;
}
