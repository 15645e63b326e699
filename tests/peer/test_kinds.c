// The list of engines: found by name, each with all that a legend and a sweep need.
#include <string.h>

#include "peer/peer.h"

#include "../check.h"

int main(void)
{
	CHECK(!ob_peer_find("no-such-engine"));
	CHECK(ob_peer_find("obsim") == ob_peer_kinds[0]);
	for (const ob_peer_kind *const *k = ob_peer_kinds; *k; k++) {
		CHECK(ob_peer_find((*k)->name) == *k);
		CHECK((*k)->title && (*k)->title[0] && (*k)->version);
		CHECK((*k)->usual.step > 0 && (*k)->usual.substeps > 0);
		bool usual_is_a_choice = !(*k)->usual.iterations;
		for (int i = 0; (*k)->iteration_choice[i]; i++) {
			CHECK(i < 7); // 0 ends
			CHECK(!i || (*k)->iteration_choice[i] > (*k)->iteration_choice[i - 1]);
			usual_is_a_choice |= (*k)->iteration_choice[i] == (*k)->usual.iterations;
		}
		CHECK(usual_is_a_choice);
		CHECK((*k)->create && (*k)->step && (*k)->get && (*k)->destroy);
	}
	return check_end();
}
