"""Between the nodes of the cloth and the points of the flow: free part, patch and mapping."""
