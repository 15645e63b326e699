-- expect: watch: expected a function(run), got 3
ground {}
watch(3)
