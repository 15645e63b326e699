-- expect: :2: error raised with a table in place of a message
error({})
