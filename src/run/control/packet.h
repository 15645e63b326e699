// Packets between a program that controls a run and the run's host.
//
//   program                                host
//     hello  ------------------------------->  takes it, or refuses: no run to control, or another controls it
//            <-------------------------------  answer
//     command ------------------------------>  carried out at a step boundary
//            <-------------------------------  answer: when it is done
//     closes the socket: the run ends
//
// Each answer begins with an error text, which is empty if all went well. A host of another version, or one that cannot be
// controlled, sends the text alone.
#ifndef OB_CONTROL_PACKET_H
#define OB_CONTROL_PACKET_H

#include <ob/control.h>

#define OB_CONTROL_MAGIC "OBSIMCT1" // its last character is the version
enum { OB_CONTROL_PAYLOAD = 60000, OB_CONTROL_IDS = 1000 };

typedef enum ob_control_command {
	OB_CONTROL_HELLO,
	OB_CONTROL_STEP, // number: steps; the answer comes when they are complete. payload: count changes of motors, then of
	// forces, made before
	OB_CONTROL_RUN, // value: pace; the answer comes at once
	OB_CONTROL_PAUSE,
	OB_CONTROL_SNAPSHOT, // the answer has its number
	OB_CONTROL_RESTORE, // number: of the snapshot
	OB_CONTROL_FORGET, // number: of the snapshot
	OB_CONTROL_FORCE, // payload: count changes; likewise below
	OB_CONTROL_KICK,
	OB_CONTROL_STATE,
	OB_CONTROL_COLOUR,
	OB_CONTROL_REMOVE,
	OB_CONTROL_CREATE, // payload: text of a scene; the answer has the ids
	OB_CONTROL_MESSAGE, // payload: a change, then count words, each ended by 0
	OB_CONTROL_TORQUE, // payload: count changes; likewise below
	OB_CONTROL_PUSH,
	OB_CONTROL_DRAG,
	OB_CONTROL_RELEASE,
	OB_CONTROL_FRICTION,
	OB_CONTROL_KILL,
	OB_CONTROL_SURFACE,
	OB_CONTROL_RESET, // value: 1 = number is a seed; payload: count words "name=value", each ended by 0
	OB_CONTROL_SAVE, // payload: path of a checkpoint file, ended by 0
	OB_CONTROL_SUBSCRIBE, // number: 1 = to contacts that begin and end, 0 = no longer
	OB_CONTROL_EVENTS, // the answer has some of them, oldest first, and in number how many were lost
	OB_CONTROL_MOTOR, // payload: count changes; likewise the next
	OB_CONTROL_UNJOIN,
	OB_CONTROL_PATH, // payload: a change (value: turns, loop), then count ob_path_point
	OB_CONTROL_COMMANDS
} ob_control_command;

typedef struct ob_control_packet {
	char magic[8];
	uint32_t command; // ob_control_command
	uint32_t count, bytes; // of the payload
	uint32_t forces; // of OB_CONTROL_STEP
	uint64_t number;
	double value;
	unsigned char payload[OB_CONTROL_PAYLOAD]; // the first bytes of it are sent
} ob_control_packet;

typedef struct ob_control_answer {
	ob_error error;
	uint64_t step, number;
	double time; // s, simulated
	uint32_t count, zero;
	union {
		uint32_t id[OB_CONTROL_IDS];
		ob_contact_event event[OB_CONTROL_IDS / 4];
	};
} ob_control_answer;

#endif
