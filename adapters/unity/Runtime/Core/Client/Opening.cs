namespace Pacinian
{
    /// <summary>A connection, or why there is none.</summary>
    internal struct Opening
    {
        public Connection Connection;
        public string Problem;

        /// <summary>What a connection file says.</summary>
        public static Opening Of(string path)
        {
            string problem;
            Connection connection = Connection.Read(path, out problem);
            return new Opening { Connection = connection, Problem = problem };
        }
    }
}
