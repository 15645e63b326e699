// Records of a simulator arrive as they were put. A word changed in its outbox is detected with the measure checksum,
// and blamed on it; without, it counts as a result. Data left by a dead simulator is not taken for records of its
// successor, nor for the object that it is processing.
#include "../check.h"

#include <pthread.h>
#include <string.h>
#include <time.h>

#include "table/checkpoint.h"
#include "table/layout.h"
#include "table/outbox.h"

enum { KIND = 7, WORDS = 5 };

static const uint64_t sent[WORDS] = { 1, 2, 3, UINT64_MAX, 1234567 };

// Submits one record and collects it, both in this process; spoil: after it was put.
static void hand_over(uint32_t harden, bool spoil)
{
	ob_error e;
	ob_mail mail = { 0 };
	ob_mail_record got;
	size_t bytes;
	ob_universe_setup setup = { .capacity = 1, .workers = 2, .isolation = "process", .harden = harden };
	ob_universe *u = ob_universe_create(&setup, &e);
	CHECK(u && ob_outbox_enter(u, 0));
	if (!u)
		return;
	u->gate_group[0].expected = 1;
	ob_outbox_begin(u);
	ob_outbox_put(u, KIND, sent, sizeof sent, NULL, 0);
	uint64_t *word = ob_outbox_own(u, &bytes);
	while (spoil && *word != sent[WORDS - 1])
		word++;
	*word += spoil;
	ob_outbox_arrive(u);
	CHECK(ob_mail_collect(u, &mail));
	const bool noticed = spoil && harden & 1 << OB_HARDEN_CHECKSUM;
	CHECK(ob_step_failed(u, NULL) == (noticed ? OB_STEP_DAMAGED : OB_STEP_OK));
	CHECK(!noticed == ob_mail_next(u, &mail, &got));
	if (!noticed) {
		CHECK(got.worker == 0 && got.kind == KIND && got.bytes == sizeof sent);
		CHECK((memcmp(got.data, sent, sizeof sent) != 0) == spoil);
		CHECK(ob_mail_next(u, &mail, &got) && got.kind == OB_OUTBOX_END);
		CHECK(!ob_mail_next(u, &mail, &got));
	}
	ob_mail_finish(&mail);
	ob_universe_destroy(u, true);
}

static bool hand_over_word(ob_universe *u, uint64_t word)
{
	if (!ob_outbox_enter(u, 0))
		return false;
	ob_outbox_begin(u);
	ob_outbox_put(u, KIND, &word, sizeof word, NULL, 0);
	ob_outbox_arrive(u);
	return true;
}

enum { PREDECESSOR = 17, SUCCESSOR = 18 };

static void *succeed(void *u)
{
	nanosleep(&(struct timespec){ .tv_nsec = 50000000 }, NULL); // the arranger waits by then
	return hand_over_word(u, SUCCESSOR) ? u : NULL;
}

// Dies busy with an object that its successor must not be blamed with.
static void die_busy(uint32_t harden)
{
	ob_error e;
	ob_universe_setup setup = { .capacity = 9, .workers = 2, .isolation = "process", .harden = harden };
	ob_universe *u = ob_universe_create(&setup, &e);
	ob_checkpoint *c = u ? ob_checkpoint_create() : NULL;
	CHECK(c && ob_checkpoint_take(c, u));
	CHECK(!harden || ob_outbox_enter(u, 0));
	ob_worker_set_object(u, 0, 5);
	CHECK(ob_worker_object(u, 0) == 5);
	ob_checkpoint_put_back(c, u);
	ob_checkpoint_forget_workers(u);
	CHECK(ob_worker_object(u, 0) == OB_NO_OBJECT);
	ob_checkpoint_destroy(c);
	ob_universe_destroy(u, true);
}

static void die_and_succeed(void)
{
	ob_error e;
	ob_mail mail = { 0 };
	ob_mail_record got;
	uint64_t word = 0;
	pthread_t successor;
	void *came;
	ob_universe_setup setup = {
		.capacity = 1, .workers = 2, .isolation = "process", .harden = 1 << OB_HARDEN_OUTBOX
	};
	ob_universe *u = ob_universe_create(&setup, &e);
	ob_checkpoint *c = u ? ob_checkpoint_create() : NULL;
	CHECK(c && ob_checkpoint_take(c, u));
	CHECK(hand_over_word(u, PREDECESSOR));
	ob_checkpoint_put_back(c, u);
	ob_checkpoint_forget_workers(u);
	u->gate_group[0].expected = 1;
	pthread_create(&successor, NULL, succeed, u);
	CHECK(ob_mail_collect(u, &mail));
	pthread_join(successor, &came);
	CHECK(came);
	CHECK(ob_step_failed(u, NULL) == OB_STEP_OK);
	CHECK(ob_mail_next(u, &mail, &got) && got.kind == KIND && got.bytes == sizeof word);
	memcpy(&word, got.data, sizeof word);
	CHECK(word == SUCCESSOR);
	ob_mail_finish(&mail);
	ob_checkpoint_destroy(c);
	ob_universe_destroy(u, true);
}

int main(void)
{
	const uint32_t plain = 1 << OB_HARDEN_OUTBOX, summed = plain | 1 << OB_HARDEN_CHECKSUM;
	hand_over(plain, false);
	hand_over(plain, true);
	hand_over(summed, false);
	hand_over(summed, true);
	die_busy(0);
	die_busy(plain);
	die_and_succeed();
	return check_end();
}
