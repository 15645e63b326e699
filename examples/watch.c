// Prints the poses of a running universe's objects: watch NAME (as `obsim top` shows it).
// cc watch.c $(pkg-config --cflags --libs obsim) -o watch
#include <stdio.h>

#include <ob/motion.h>
#include <ob/universe.h>

int main(int argc, char **argv)
{
	ob_error e = { "usage: watch NAME" };
	ob_universe *u = argc == 2 ? ob_universe_attach(argv[1], &e) : NULL;
	if (!u) {
		fprintf(stderr, "watch: %s\n", e.text);
		return 1;
	}
	ob_universe_info info;
	ob_universe_get_info(u, &info);
	printf("# %s: %u objects at %.3f s\n", info.name, info.objects, info.time);
	for (uint32_t id = 0; id < info.capacity; id++) {
		ob_passport passport;
		ob_motion motion;
		if (!ob_universe_get_passport(u, id, &passport) || !ob_universe_get_motion(u, id, &motion))
			continue; // the id is free
		// A motion holds from its own instant on: any later one may be evaluated.
		ob_state now = ob_motion_at(&motion, passport.inertia, info.time);
		printf("%u %s %.6f %.6f %.6f\n", id, passport.name, now.pose.p.x, now.pose.p.y, now.pose.p.z);
	}
	ob_universe_detach(u);
	return 0;
}
