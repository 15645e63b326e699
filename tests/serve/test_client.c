// Queue of messages to a viewer: in order, bounded, and released.
#include "check.h"

#include "serve/client.h"

static ob_message *message_of(size_t size)
{
	static const char bytes[100000];
	ob_message *m = ob_message_new(false);
	while (m->size < size)
		ob_message_put(m, bytes, size - m->size < sizeof bytes ? size - m->size : sizeof bytes);
	return m;
}

static void test_limits(void)
{
	static ob_client_queue q;
	ob_message *small = message_of(10), *large = message_of(OB_CLIENT_BYTES - 5),
		   *huge = message_of(2 * OB_CLIENT_BYTES);
	for (int i = 0; i < OB_CLIENT_QUEUE; i++)
		CHECK(ob_client_queue_put(&q, small));
	CHECK(small->holders == OB_CLIENT_QUEUE + 1 && q.bytes == 10 * OB_CLIENT_QUEUE);
	CHECK(!ob_client_queue_put(&q, small) && q.count == 0 && q.bytes == 0 && small->holders == 1);
	CHECK(ob_client_queue_put(&q, large) && !ob_client_queue_put(&q, small) && q.count == 0);
	CHECK(ob_client_queue_put(&q, huge) && q.count == 1); // or a large universe could never be sent
	q.sent = 1000;
	CHECK(!ob_client_queue_put(&q, small) && q.count == 1 && huge->holders == 2); // half of it is sent already
	ob_client_queue_clear(&q);
	CHECK(q.count == 0 && q.sent == 0 && huge->holders == 1 && large->holders == 1);
	ob_message_release(small);
	ob_message_release(large);
	ob_message_release(huge);
}

static void test_allowance(void)
{
	ob_allowance a = { 10, 100 };
	int taken = 0;
	for (int i = 0; i < 50; i++)
		taken += ob_allowance_take(&a, 100, 10);
	CHECK(taken == 10);
	CHECK(ob_allowance_take(&a, 100.15, 10) && !ob_allowance_take(&a, 100.15, 10));
	taken = 0;
	for (int i = 0; i < 50; i++)
		taken += ob_allowance_take(&a, 1000, 10);
	CHECK(taken == 10);
}

int main(void)
{
	test_limits();
	test_allowance();
	return check_end();
}
